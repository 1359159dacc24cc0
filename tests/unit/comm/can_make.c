#include "can_make.h"

static can_frame_t protect(uint32_t message, const uint8_t data[CAN_MAX_BYTES], uint8_t alive) {
    const e2e_layout_t *layout = &quiesce_can_messages[message].e2e;
    can_frame_t frame = {.id = layout->id, .length = layout->length};
    for (uint32_t i = 0; i < frame.length && i < CAN_MAX_BYTES; i++) {
        frame.data[i] = data[i];
    }
    e2e_protect(layout, &alive, &frame);
    return frame;
}

can_frame_t make_stop(uint16_t code, uint8_t alive) {
    const struct quiesce_can_emergency_stop_t wire = {.code = code};
    uint8_t data[CAN_MAX_BYTES];
    (void)quiesce_can_emergency_stop_pack(data, &wire, sizeof data);
    return protect(QUIESCE_CAN_AT_EMERGENCY_STOP, data, alive);
}

can_frame_t make_sample(uint32_t sensor, int32_t counts, uint8_t alive) {
    const can_frame_t first = make_accel(counts, false, false, alive);
    return protect(QUIESCE_CAN_AT_ACCEL_SAMPLE + sensor, first.data, alive);
}

can_frame_t make_accel(int32_t counts, bool is_saturated, bool is_bad, uint8_t alive) {
    const struct quiesce_can_accel_sample_t wire = {
        .accel_counts = counts,
        .is_saturated = is_saturated,
        .is_bad = is_bad,
    };
    uint8_t data[CAN_MAX_BYTES];
    (void)quiesce_can_accel_sample_pack(data, &wire, sizeof data);
    return protect(QUIESCE_CAN_AT_ACCEL_SAMPLE, data, alive);
}

can_frame_t make_current(int16_t current_mA, uint8_t alive) {
    return make_driver(current_mA, QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_OK_CHOICE, alive);
}

can_frame_t make_driver(int16_t current_mA, uint8_t driver_status, uint8_t alive) {
    return make_driver_of(0, current_mA, driver_status, alive);
}

can_frame_t make_driver_of(uint32_t damper, int16_t current_mA, uint8_t driver_status,
                           uint8_t alive) {
    const struct quiesce_can_current_measured_t wire = {
        .current_meas_mA = current_mA,
        .driver_status = driver_status,
    };
    uint8_t data[CAN_MAX_BYTES];
    (void)quiesce_can_current_measured_pack(data, &wire, sizeof data);
    return protect(QUIESCE_CAN_AT_CURRENT_MEASURED + damper, data, alive);
}

can_frame_t make_operator(bool enable, bool fault_reset, uint8_t alive) {
    const struct quiesce_can_operator_command_t wire = {
        .enable = enable,
        .fault_reset = fault_reset,
    };
    uint8_t data[CAN_MAX_BYTES];
    (void)quiesce_can_operator_command_pack(data, &wire, sizeof data);
    return protect(QUIESCE_CAN_AT_OPERATOR_COMMAND, data, alive);
}

can_frame_t make_request(uint8_t operation, uint8_t index, int32_t value, uint8_t alive) {
    const struct quiesce_can_service_request_t wire = {
        .operation = operation,
        .param_index = index,
        .param_value = value,
    };
    uint8_t data[CAN_MAX_BYTES];
    (void)quiesce_can_service_request_pack(data, &wire, sizeof data);
    return protect(QUIESCE_CAN_AT_SERVICE_REQUEST, data, alive);
}

uint32_t message_of(const can_frame_t *frame) {
    for (uint32_t i = 0; i < QUIESCE_CAN_MESSAGES; i++) {
        if (quiesce_can_messages[i].e2e.id == frame->id) {
            return i;
        }
    }
    return QUIESCE_CAN_MESSAGES;
}

bool is_well_made(const can_frame_t *frame) {
    const uint32_t message = message_of(frame);
    if (message == QUIESCE_CAN_MESSAGES || frame->is_extended || frame->is_remote) {
        return false;
    }
    const quiesce_can_message_t *row = &quiesce_can_messages[message];
    return frame->length == row->e2e.length &&
           (!row->is_protected || frame->data[row->e2e.crc_byte] == e2e_crc(&row->e2e, frame));
}
