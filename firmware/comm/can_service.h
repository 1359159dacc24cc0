/// ServiceRequest and ServiceReply: parameters, raw samples, what is kept of faults. One request at
/// a time; another one before its reply has gone is answered BUSY, and a third is not answered at
/// all.
#ifndef CAN_SERVICE_H
#define CAN_SERVICE_H

#include "can_freeze.h"
#include "fault_record.h"
#include "quiesce.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CAN_SERVICE_MAX_RAW_S 3600
/// A task that is not answered by then has failed.
#define CAN_SERVICE_SAVE_MS 2000u
/// Of an image: four sectors of flash are erased, each of which may take 2 s.
#define CAN_SERVICE_IMAGE_MS 20000u

/// What the node cannot do by itself; the application does it and answers with can_node_answer.
typedef enum {
    CAN_NODE_NOTHING = 0,
    CAN_NODE_APPLY = 1, ///< put can_node_staged to use: check, restart from rest
    CAN_NODE_SAVE = 2,  ///< store the parameters in effect
    CAN_NODE_TABLE = 3, ///< a request about tables: can_node_request says which
    CAN_NODE_IMAGE = 4, ///< likewise about the program itself
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
    CAN_NODE_FAULT_IS_LATCHED = 8,
    CAN_NODE_IS_ARMED = 9,
    CAN_NODE_TABLE_REFUSED = 10,    ///< param_value: quiesce_table_verdict_t
    CAN_NODE_NOTHING_RECEIVED = 11, ///< no whole transfer, or of another CRC
    CAN_NODE_NO_SUCH_TABLE = 12,    ///< no such road, or nothing of that number to tell
    CAN_NODE_IMAGE_REFUSED = 13,    ///< not whole, not for this board or this place
} can_node_result_t;

typedef struct {
    uint8_t operation;
    uint8_t param_index;
    uint8_t alive;
    can_node_result_t result;
    int32_t param_value;
} can_service_reply_t;

/// A request that the application works on.
typedef struct {
    uint8_t operation; ///< QUIESCE_CAN_SERVICE_REQUEST_OPERATION_..
    uint8_t index;
    int32_t value;
} can_service_request_t;

typedef struct {
    quiesce_params_t in_effect;
    quiesce_params_t staged;
    bool has_staged;
    can_node_task_t task;
    can_service_request_t request; ///< that is worked on
    can_service_reply_t reply;     ///< of it
    can_service_reply_t busy;      ///< of one that came too early
    bool is_taken;                 ///< reply is in use
    bool has_busy;
    uint32_t quiet_ms; ///< until the next reply may be sent
    uint32_t raw_ms;   ///< left of the stream of raw samples
    uint32_t save_ms;  ///< left for a task that waits for a store
} can_service_t;

void can_service_init(can_service_t *self, const quiesce_params_t *params);

/// Other parameters are in effect; nothing is staged. A request that is worked on goes on.
void can_service_use_params(can_service_t *self, const quiesce_params_t *params);

/// What is kept of faults.
typedef struct {
    can_freeze_t *freeze;
    fault_record_t *record;
} can_service_held_t;

/// Takes a request whose CRC was right.
void can_service_request(can_service_t *self, const can_frame_t *frame,
                         const can_service_held_t *held);

/// Answers the task in hand; nothing happens where there is none.
void can_service_answer(can_service_t *self, can_node_result_t result, uint32_t param_index);

/// The same with the reply's value.
void can_service_answer_value(can_service_t *self, can_node_result_t result, int32_t value);

/// Time passes. A SAVE, or a task about tables or the program, that takes too long is answered
/// STORE_FAILED; the service is free again.
void can_service_elapse(can_service_t *self, uint32_t passed_ms);

/// The next reply, packed but not protected, and its alive counter. Returns false iff none is due.
bool can_service_reply(can_service_t *self, can_frame_t *frame, uint8_t *alive);

#ifdef __cplusplus
}
#endif

#endif
