/// A controller with its CAN interface behind the lock-step stimulus: what a board with sensors and
/// drivers of its own does, its frames included, one call a tick. Its operator's enable, stop and
/// acknowledgement are the stimulus's; stops and acknowledgements of the bus add.
#ifndef LOCKSTEP_NODE_H
#define LOCKSTEP_NODE_H

#include "lockstep.h"
#include "node.h"

#ifdef __cplusplus
extern "C" {
#endif

/// How the ticks come, for LoopTiming.
typedef struct {
    uint32_t lateness_us; ///< of this tick
    uint32_t work_us;     ///< of the one before
    uint32_t overruns;    ///< ticks so far that began a whole tick late
    can_unsent_t unsent;  ///< frames so far that the bus did not take
    uint32_t rx_lost;     ///< times so far that what had come was lost
} lockstep_pace_t;

typedef struct {
    node_t node;
    lockstep_refusal_t refused; ///< by the last start
    uint32_t missed;            ///< ticks with LOCKSTEP_LOST since the last one that ran
} lockstep_node_t;

/// As lockstep_start. What is to outlive a restart is refused: it has no memory for that.
bool lockstep_node_start(lockstep_node_t *self, const quiesce_board_t *board,
                         const quiesce_params_t *params, const lockstep_table_t *tables);

/// As lockstep_exchange, the same bits where the bus says nothing. Writes the tick's frames and
/// returns their number; 0 of a lost one.
uint32_t lockstep_node_exchange(lockstep_node_t *self, const lockstep_stimulus_t *in,
                                const lockstep_pace_t *pace, lockstep_reply_t *out,
                                can_frame_t frames[NODE_MAX_FRAMES]);

#ifdef __cplusplus
}
#endif

#endif
