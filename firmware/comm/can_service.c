#include "can_service.h"

#include <stddef.h>

#include "quiesce_can.h"
#include "quiesce_can_tables.h"

void can_service_init(can_service_t *self, const quiesce_params_t *params) {
    *self = (can_service_t){.in_effect = *params, .staged = *params};
}

void can_service_use_params(can_service_t *self, const quiesce_params_t *params) {
    self->in_effect = *params;
    self->staged = *params;
    self->has_staged = false;
}

static can_node_result_t read_param(const can_service_t *self, can_service_reply_t *reply) {
    return quiesce_param_get(&self->in_effect, reply->param_index, &reply->param_value)
               ? CAN_NODE_DONE
               : CAN_NODE_NO_SUCH_PARAMETER;
}

static can_node_result_t stage(can_service_t *self, can_service_reply_t *reply, int32_t value) {
    if (reply->param_index >= QUIESCE_PARAM_COUNT) {
        return CAN_NODE_NO_SUCH_PARAMETER;
    }
    if (!quiesce_param_allows(reply->param_index, value)) {
        return CAN_NODE_OUT_OF_RANGE;
    }
    (void)quiesce_param_set(&self->staged, reply->param_index, value);
    self->has_staged = true;
    reply->param_value = value;
    return CAN_NODE_DONE;
}

static can_node_result_t stream(can_service_t *self, int32_t time_s) {
    if (time_s < 0 || time_s > CAN_SERVICE_MAX_RAW_S) {
        return CAN_NODE_OUT_OF_RANGE;
    }
    self->raw_ms = (uint32_t)time_s * 1000u;
    return CAN_NODE_DONE;
}

static can_node_result_t discard(can_service_t *self) {
    self->staged = self->in_effect;
    self->has_staged = false;
    return CAN_NODE_DONE;
}

// value: the first page, plus 65536 times how many.
static can_node_result_t send_record(fault_record_t *record, int32_t value,
                                     can_service_reply_t *reply) {
    const uint32_t pages = (uint32_t)value;
    if (fault_record_is_busy(record)) {
        return CAN_NODE_BUSY;
    }
    if (!record->is_held) {
        return CAN_NODE_NOTHING_TO_SEND;
    }
    if (!fault_record_request(record, pages & UINT16_MAX, pages >> 16)) {
        return CAN_NODE_OUT_OF_RANGE;
    }
    reply->param_value = (int32_t)(FAULT_RECORD_PAGES | record->later << 16);
    return CAN_NODE_DONE;
}

static can_node_result_t clear_record(fault_record_t *record) {
    if (fault_record_is_busy(record)) {
        return CAN_NODE_BUSY;
    }
    return fault_record_clear(record) ? CAN_NODE_DONE : CAN_NODE_NOTHING_TO_SEND;
}

static can_node_result_t act(can_service_t *self, int32_t value, const can_service_held_t *held) {
    switch (self->reply.operation) {
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_READ_CHOICE:
        return read_param(self, &self->reply);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_STAGE_CHOICE:
        return stage(self, &self->reply, value);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_APPLY_CHOICE:
        self->task = self->has_staged ? CAN_NODE_APPLY : CAN_NODE_NOTHING;
        return CAN_NODE_DONE;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_DISCARD_CHOICE:
        return discard(self);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_SAVE_CHOICE:
        self->task = CAN_NODE_SAVE;
        self->save_ms = CAN_SERVICE_SAVE_MS;
        return CAN_NODE_DONE;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_RAW_STREAM_CHOICE:
        return stream(self, value);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_FREEZE_FRAME_CHOICE:
        return can_freeze_request(held->freeze) ? CAN_NODE_DONE : CAN_NODE_NOTHING_TO_SEND;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_FAULT_RECORD_CHOICE:
        return send_record(held->record, value, &self->reply);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_CLEAR_RECORD_CHOICE:
        return clear_record(held->record);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_CHECK_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_COMMIT_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_REVERT_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SHIP_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SAVE_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_INFO_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SEND_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_LEARNT_RESTORE_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_LEARNT_FORGET_CHOICE:
        self->task = CAN_NODE_TABLE;
        self->save_ms = CAN_SERVICE_SAVE_MS;
        return CAN_NODE_DONE;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_INFO_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_PREPARE_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_PIECE_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_FINISH_CHOICE:
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_START_CHOICE:
        self->task = CAN_NODE_IMAGE;
        self->save_ms = CAN_SERVICE_IMAGE_MS;
        return CAN_NODE_DONE;
    default:
        return CAN_NODE_NO_SUCH_OPERATION;
    }
}

void can_service_request(can_service_t *self, const can_frame_t *frame,
                         const can_service_held_t *held) {
    struct quiesce_can_service_request_t request;
    (void)quiesce_can_service_request_unpack(&request, frame->data, frame->length);
    can_service_reply_t reply = {
        .operation = request.operation,
        .param_index = request.param_index,
        .alive = request.alive,
        .result = CAN_NODE_BUSY,
    };
    if (self->is_taken) {
        if (!self->has_busy) {
            self->busy = reply;
            self->has_busy = true;
        }
        return;
    }
    self->is_taken = true;
    self->reply = reply;
    self->request =
        (can_service_request_t){request.operation, request.param_index, request.param_value};
    self->reply.result = act(self, request.param_value, held);
}

void can_service_answer(can_service_t *self, can_node_result_t result, uint32_t param_index) {
    if (self->task == CAN_NODE_NOTHING) {
        return;
    }
    if (self->task == CAN_NODE_APPLY && result != CAN_NODE_DONE) {
        self->reply.param_index = quiesce_can_service_reply_param_index_sat(param_index);
    }
    self->reply.result = result;
    self->task = CAN_NODE_NOTHING;
}

void can_service_answer_value(can_service_t *self, can_node_result_t result, int32_t value) {
    self->reply.param_value = value;
    can_service_answer(self, result, 0);
}

static uint32_t minus(uint32_t from, uint32_t amount) {
    return from > amount ? from - amount : 0u;
}

void can_service_elapse(can_service_t *self, uint32_t passed_ms) {
    self->quiet_ms = minus(self->quiet_ms, passed_ms);
    self->raw_ms = minus(self->raw_ms, passed_ms);
    self->save_ms = minus(self->save_ms, passed_ms);
    const bool can_wait =
        self->task == CAN_NODE_SAVE || self->task == CAN_NODE_TABLE || self->task == CAN_NODE_IMAGE;
    if (can_wait && self->save_ms == 0u) {
        can_service_answer(self, CAN_NODE_STORE_FAILED, 0);
    }
}

static void pack(const can_service_reply_t *reply, can_frame_t *frame, uint8_t *alive) {
    const struct quiesce_can_service_reply_t wire = {
        .operation = reply->operation,
        .param_index = reply->param_index,
        .result = quiesce_can_service_reply_result_sat(reply->result),
        .param_value = reply->param_value,
    };
    (void)quiesce_can_service_reply_pack(frame->data, &wire, sizeof frame->data);
    *alive = reply->alive;
}

bool can_service_reply(can_service_t *self, can_frame_t *frame, uint8_t *alive) {
    const bool is_ready = self->is_taken && self->task == CAN_NODE_NOTHING;
    if (self->quiet_ms > 0u || (!is_ready && !self->has_busy)) {
        return false;
    }
    if (is_ready) {
        pack(&self->reply, frame, alive);
        self->is_taken = false;
    } else {
        pack(&self->busy, frame, alive);
        self->has_busy = false;
    }
    self->quiet_ms = quiesce_can_messages[QUIESCE_CAN_AT_SERVICE_REPLY].delay_ms;
    return true;
}
