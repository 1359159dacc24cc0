#include "view_signal.h"

#include <stddef.h>

#include "fixq.h"

#define OF_BODY(field, quantity)                                                                   \
    { offsetof(view_t, body) + offsetof(view_body_t, field), sizeof(view_body_t), quantity }
#define OF_DAMPER(field, quantity)                                                                 \
    { offsetof(view_t, damper) + offsetof(view_damper_t, field), sizeof(view_damper_t), quantity }

const view_quantity_t view_quantity[VIEW_SIGNAL_QUANTITIES] = {
    [QUIESCE_SENSE_ACCEL] = OF_BODY(accel_um_s2, QUIESCE_VALID_ACCEL),
    [QUIESCE_SENSE_VELOCITY] = OF_BODY(velocity_um_s, QUIESCE_VALID_VELOCITY),
    [QUIESCE_SENSE_DISPLACEMENT] = OF_BODY(displacement_nm, QUIESCE_VALID_DISPLACEMENT),
    [QUIESCE_SENSE_STROKE] = OF_DAMPER(stroke_nm, QUIESCE_VALID_STROKE),
    [QUIESCE_SENSE_STROKE_VELOCITY] = OF_DAMPER(velocity_um_s, QUIESCE_VALID_STROKE_VELOCITY),
    [QUIESCE_SENSE_FORCE] = OF_DAMPER(force_mN, QUIESCE_VALID_FORCE),
    [QUIESCE_SENSE_VOLTAGE] = OF_DAMPER(voltage_mV, QUIESCE_VALID_VOLTAGE),
    [QUIESCE_SENSE_TEMPERATURE] = OF_DAMPER(temperature_mdegC, QUIESCE_VALID_TEMPERATURE),
    [QUIESCE_SENSE_SUPPLY] = {offsetof(view_t, supply_mV), 0, QUIESCE_VALID_SUPPLY},
    [VIEW_SIGNAL_CURRENT] = OF_DAMPER(current_mA, QUIESCE_VALID_CURRENT),
};

static uint32_t quantity_of(uint32_t signal) {
    return signal & 0xFFu;
}

static uint32_t place_of(uint32_t signal) {
    return signal >> 8;
}

bool view_signal_is_good(uint32_t signal) {
    const uint32_t places = quantity_of(signal) == QUIESCE_SENSE_SUPPLY ? 1u : QUIESCE_MAX_DAMPERS;
    return quantity_of(signal) < VIEW_SIGNAL_QUANTITIES && place_of(signal) < places;
}

_Static_assert(QUIESCE_MAX_BODIES == QUIESCE_MAX_DAMPERS, "one limit for both");

static bool is_good(const view_input_t *input) {
    return view_signal_is_good(input->signal) && input->limit > 0 && input->limit <= VIEW_LIMIT &&
           input->shift < 30u && input->limit <= VIEW_LIMIT >> input->shift;
}

bool view_inputs_are_good(const view_input_t *inputs, uint32_t count) {
    bool are_good = count <= VIEW_INPUTS_MAX;
    for (uint32_t i = 0; i < count && are_good; i++) {
        are_good = is_good(&inputs[i]);
    }
    return are_good;
}

uint64_t view_signal_needs(uint32_t signal) {
    return UINT64_C(1) << (view_quantity[quantity_of(signal)].valid + place_of(signal));
}

uint64_t view_inputs_need(const view_input_t *inputs, uint32_t count) {
    uint64_t needs = 0;
    for (uint32_t i = 0; i < count; i++) {
        needs |= view_signal_needs(inputs[i].signal);
    }
    return needs;
}

int32_t view_signal_value(const view_t *view, uint32_t signal) {
    const view_quantity_t *quantity = &view_quantity[quantity_of(signal)];
    const uint8_t *at =
        (const uint8_t *)view + quantity->offset + quantity->stride * (size_t)place_of(signal);
    return *(const int32_t *)(const void *)at;
}

void view_inputs_read(const view_input_t *inputs, uint32_t count, const view_t *view,
                      int32_t *out) {
    for (uint32_t i = 0; i < count; i++) {
        const int32_t limit = inputs[i].limit;
        const int32_t value = clamp_i32(view_signal_value(view, inputs[i].signal), -limit, limit);
        out[i] = (int32_t)((uint32_t)value << inputs[i].shift);
    }
}
