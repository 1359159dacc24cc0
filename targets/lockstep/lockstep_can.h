/// Lock-step server over CAN frames: the protocol between a bench and a target (quiesce.dbc).
///
/// Pure: one frame in, its replies out; it knows no bus. The bench writes parameters and, word by
/// word, the board and the tables, starts with or without that board, then sends one
/// LockstepStimulus a tick.
/// Before it, with the same sequence number: a LockstepSensor for each new sample of the sensors
/// beyond the first, a LockstepCurrent for each measured current. It gets, in this order, the
/// telemetry frames that are due, a LockstepDamper for each damper of the board beyond the first,
/// and one LockstepCommand. A frame that is unknown, of the wrong length, out of place or of the
/// wrong sequence number is counted and never acted on.
#ifndef LOCKSTEP_CAN_H
#define LOCKSTEP_CAN_H

#include "can_frame.h"
#include "lockstep.h"
#include "quiesce_can.h"

/// Most frames that one frame is answered with: all telemetry words and the commands.
#define LOCKSTEP_CAN_MAX_REPLIES (QUIESCE_CAN_TELEMETRY_WORDS + QUIESCE_MAX_DAMPERS)

/// LockstepParamWrite: index of the first of the words of quiesce_board_t, in memory order.
#define LOCKSTEP_CAN_BOARD_INDEX 0x4000u
#define LOCKSTEP_CAN_BOARD_WORDS (sizeof(quiesce_board_t) / sizeof(int32_t))

/// LockstepParamWrite: index of the first of the words of the law's table, then of those of the
/// tracker's. The last index of each is the number of words: 0, as at first, where there is none.
/// Writing there ends the run; stimuli are out of place until the next start.
#define LOCKSTEP_CAN_TABLE_INDEX 0x8000u
#define LOCKSTEP_CAN_TABLE_INDICES 0x2000u
#define LOCKSTEP_CAN_TABLE_COUNT (LOCKSTEP_CAN_TABLE_INDICES - 1u)

/// Sequence numbers run from 0, modulo this.
#define LOCKSTEP_CAN_SEQUENCE_PERIOD 16u

typedef struct {
    lockstep_t server;
    lockstep_reply_t reply;  ///< of the last tick
    quiesce_params_t params; ///< for the next start
    quiesce_board_t board;   ///< likewise, where it asks for a board
    uint32_t table_words[LOCKSTEP_TABLES];
    uint32_t table[LOCKSTEP_TABLES][QUIESCE_TABLE_WORDS]; ///< likewise; in use from then on
    uint32_t dampers;                                     ///< that this start has
    uint32_t telemetry_every_ticks;
    uint32_t telemetry_frames;
    uint32_t telemetry_word; ///< next one to send
    uint32_t ticks_to_burst;
    lockstep_stimulus_t pending; ///< samples and currents for the next stimulus
    uint8_t sequence;            ///< of the next stimulus
    uint8_t refused_index;       ///< of the parameter, or of the table
    uint8_t table_verdict;       ///< quiesce_table_verdict_t
    bool is_started;
    bool is_stopped; ///< the bench asked the target to end
    bool param_is_refused;
    bool board_is_refused;
    uint16_t unknown_frames;  ///< saturating
    uint16_t sequence_errors; ///< saturating
} lockstep_can_t;

/// Not started, every parameter and the board at its default, no tables.
void lockstep_can_init(lockstep_can_t *self);

/// The LockstepStatus with which a target says, once, that it listens from now on.
void lockstep_can_greet(const lockstep_can_t *self, can_frame_t *out);

/// Takes one frame. Returns the number of frames written to out, in the order to send them.
uint32_t lockstep_can_receive(lockstep_can_t *self, const can_frame_t *frame,
                              can_frame_t out[LOCKSTEP_CAN_MAX_REPLIES]);

#endif
