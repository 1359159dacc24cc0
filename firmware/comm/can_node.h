/// The controller's side of the CAN interface (quiesce.dbc): what it sends and when, what it takes
/// and when it is too old. Pure: it knows no bus and no clock but ticks.
///
/// Whatever is malformed, of a wrong CRC, stale or unknown is counted and changes nothing. A tick's
/// frames come in the order of their ids; the cyclic ones are spread over ticks so that none sends
/// more than CAN_NODE_MAX_FRAMES. Of its parts, can_receive.h takes, can_service.h answers
/// requests, can_freeze.h keeps the freeze frame, fault_record.h the record, can_schedule.h says
/// when, can_pack.h says what.
#ifndef CAN_NODE_H
#define CAN_NODE_H

#include "can_frame.h"
#include "can_freeze.h"
#include "can_pack.h"
#include "can_receive.h"
#include "can_schedule.h"
#include "can_service.h"
#include "fault_record.h"
#include "quiesce.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Frames of a tick at the most: a demand for each damper, raw sample, a page of the freeze frame,
/// a reply, and cyclic ones.
#define CAN_NODE_MAX_FRAMES (6u + QUIESCE_DAMPERS)

/// Contents are private.
typedef struct {
    can_receive_t receive;
    can_service_t service;
    can_freeze_t freeze;
    can_schedule_t schedule;
    fault_record_t record;
    uint8_t alive[QUIESCE_CAN_MESSAGES]; ///< of the next frame of each
    uint32_t dampers;                    ///< that are sent their current
    uint32_t param_hash;
    uint32_t lateness_max_us; ///< since the last LoopTiming
    uint32_t work_max_us;
    can_cycles_t most_cycles; ///< since the last LoopCycles
    uint32_t report_number;   ///< of the law's report, in the next LawState
} can_node_t;

/// Forgets everything; parameters in effect are params (their tick rate gives the cycle times;
/// 1000 Hz where it is one that the controller refuses). board: NULL where parameters say what is
/// wired.
void can_node_init(can_node_t *self, const quiesce_board_t *board, const quiesce_params_t *params);

/// The controller was restarted with the same board and other parameters: their rate and hash,
/// nothing staged. Counters, alive counters and receivers go on.
void can_node_use_params(can_node_t *self, const quiesce_board_t *board,
                         const quiesce_params_t *params);

/// Other values of live parameters are in effect; nothing staged. All else goes on.
void can_node_retune(can_node_t *self, const quiesce_params_t *params);

/// Takes one received frame. Bounded; call it for every frame before the tick.
void can_node_receive(can_node_t *self, const can_frame_t *frame);

/// A tick begins: ages what was received and hands it over. Once a tick.
/// ticks: since the last one; 1, more where ticks were lost.
void can_node_inputs(can_node_t *self, uint32_t ticks, can_node_inputs_t *inputs);

/// What a request asks of the application; the same until it is answered.
can_node_task_t can_node_task(const can_node_t *self);

/// Parameters as staged; only for CAN_NODE_APPLY.
const quiesce_params_t *can_node_staged(const can_node_t *self);

/// The request that CAN_NODE_TABLE or CAN_NODE_IMAGE is about.
const can_service_request_t *can_node_request(const can_node_t *self);

/// Answers the task. param_index: of the parameter that was refused, else 0.
void can_node_answer(can_node_t *self, can_node_result_t result, uint32_t param_index);

/// Answers it with a value.
void can_node_answer_value(can_node_t *self, can_node_result_t result, int32_t value);

/// The frames that are due after the control step of this controller. Returns their number.
uint32_t can_node_tick(can_node_t *self, const can_node_tick_t *tick, const quiesce_out_t *out,
                       const quiesce_t *controller, can_frame_t frames[CAN_NODE_MAX_FRAMES]);

/// The demand frame of a damper alone, for the moment when the controller leaves: safe current,
/// output off.
void can_node_farewell(can_node_t *self, uint32_t damper, int32_t safe_mA, can_frame_t *frame);

const can_node_counters_t *can_node_counters(const can_node_t *self);

/// CRC-32 of the parameters: their words in index order, little-endian (Identification).
uint32_t can_node_param_hash(const quiesce_params_t *params);

#ifdef __cplusplus
}
#endif

#endif
