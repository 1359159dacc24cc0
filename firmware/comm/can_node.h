/// The controller's side of the CAN interface (quiesce.dbc): what it sends and when, what it takes
/// and when it is too old. Pure: it knows no bus and no clock but ticks.
///
/// Whatever is malformed, of a wrong CRC, stale or unknown is counted and changes nothing. A tick's
/// frames come in the order of their ids; the cyclic ones are spread over ticks so that none sends
/// more than CAN_NODE_MAX_FRAMES.
#ifndef CAN_NODE_H
#define CAN_NODE_H

#include "can_frame.h"
#include "e2e.h"
#include "quiesce.h"

/// Frames of a tick at the most: demand, raw sample, a page of the freeze frame, a reply, and three
/// cyclic ones.
#define CAN_NODE_MAX_FRAMES 7u

/// What the node cannot do by itself; the application does it and answers with can_node_answer.
typedef enum {
    CAN_NODE_NOTHING = 0,
    CAN_NODE_APPLY = 1, ///< put can_node_staged to use: check, restart from rest
    CAN_NODE_SAVE = 2,  ///< store the parameters in effect
} can_node_task_t;

/// ServiceReply's result.
typedef enum {
    CAN_NODE_DONE = 0,
    CAN_NODE_NO_SUCH_PARAMETER = 1,
    CAN_NODE_OUT_OF_RANGE = 2,
    CAN_NODE_CONTRADICTION = 3,
    CAN_NODE_NO_SUCH_OPERATION = 4,
    CAN_NODE_STORE_FAILED = 5,
    CAN_NODE_BUSY = 6,
    CAN_NODE_NOTHING_TO_SEND = 7,
} can_node_result_t;

/// What the bus says in this tick.
typedef struct {
    bool enable;      ///< OperatorCommand, not older than its timeout
    bool fault_reset; ///< likewise
    bool estop;       ///< EmergencyStop, not older than its timeout
    bool accel_is_fresh;
    int32_t accel_counts; ///< written only where accel_is_fresh
    bool current_is_measured;
    int32_t current_meas_mA; ///< written only where current_is_measured
} can_node_inputs_t;

/// What the target tells the bus beyond the controller's output.
typedef struct {
    bool enable;          ///< in force in this tick, from wherever it came
    bool estop;           ///< likewise
    int32_t accel_counts; ///< the sample that the controller was given
    bool accel_is_fresh;
    int32_t current_meas_mA;
    bool current_is_measured;
    uint32_t overruns;    ///< ticks lost since the start
    uint32_t lateness_us; ///< of this tick's start; 0 where the target cannot tell
    uint32_t work_us;     ///< of the last tick
    uint32_t tx_dropped;  ///< frames that the interface did not take, since the start
    uint32_t bus_off_count;
} can_node_tick_t;

/// Counters of what was refused, saturating at 2^32 - 1.
typedef struct {
    uint32_t rejected_crc;
    uint32_t rejected_alive;
    uint32_t rejected_shape;
    uint32_t unknown; ///< ids that are not for the controller: other nodes' traffic, no error
    uint32_t accepted;
} can_node_counters_t;

typedef struct can_node can_node_t; ///< defined below; contents are private

/// Forgets everything; parameters in effect are params (their tick rate gives the cycle times).
void can_node_init(can_node_t *self, const quiesce_params_t *params);

/// The controller was restarted with other parameters: their rate and hash, nothing staged.
/// Counters, alive counters and receivers go on.
void can_node_use_params(can_node_t *self, const quiesce_params_t *params);

/// Takes one received frame. Bounded; call it for every frame before the tick.
void can_node_receive(can_node_t *self, const can_frame_t *frame);

/// A tick begins: ages what was received and hands it over. Once a tick.
void can_node_inputs(can_node_t *self, can_node_inputs_t *inputs);

/// What a request asks of the application; the same until it is answered.
can_node_task_t can_node_task(const can_node_t *self);

/// Parameters as staged; only for CAN_NODE_APPLY.
const quiesce_params_t *can_node_staged(const can_node_t *self);

/// Answers the task. param_index: of the parameter that was refused, else 0.
void can_node_answer(can_node_t *self, can_node_result_t result, uint32_t param_index);

/// The frames that are due after the control step. Returns their number.
uint32_t can_node_tick(can_node_t *self, const can_node_tick_t *tick, const quiesce_out_t *out,
                       can_frame_t frames[CAN_NODE_MAX_FRAMES]);

/// The demand frame alone, for the moment when the controller leaves: safe current, output off.
void can_node_farewell(can_node_t *self, int32_t safe_current_mA, can_frame_t *frame);

const can_node_counters_t *can_node_counters(const can_node_t *self);

/// CRC-32 of the parameters: their words in index order, little-endian (Identification).
uint32_t can_node_param_hash(const quiesce_params_t *params);

#endif
