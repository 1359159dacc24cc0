#include "coil.h"

#define BAD_ADDS 4u

void coil_init(coil_t *self, int32_t resistance_mohm, int32_t error_mA, uint32_t fault_ticks) {
    *self = (coil_t){
        .resistance_mohm = resistance_mohm, .error_mA = error_mA, .fault_ticks = fault_ticks};
}

static int64_t magnitude(int64_t value) {
    return value < 0 ? -value : value;
}

// uV that a current needs.
static int64_t needs_uV(const coil_t *self, int32_t current_mA) {
    return magnitude((int64_t)current_mA * self->resistance_mohm);
}

bool coil_is_short(coil_t *self, int32_t command_mA, int32_t current_mA, int32_t voltage_mV) {
    if (self->resistance_mohm == 0) {
        return false;
    }
    const bool is_steady = magnitude((int64_t)command_mA - current_mA) <= self->error_mA &&
                           magnitude(current_mA) >= 2 * (int64_t)self->error_mA;
    const uint32_t limit = self->fault_ticks * BAD_ADDS;
    if (is_steady && magnitude((int64_t)voltage_mV * 1000) < needs_uV(self, current_mA) / 4) {
        self->bad += self->bad < limit ? BAD_ADDS : 0u;
    } else if (self->bad > 0u) {
        self->bad--;
    }
    return self->bad >= limit;
}

bool coil_is_open(const coil_t *self, int32_t expected_mA, int32_t voltage_mV) {
    return magnitude((int64_t)voltage_mV * 1000) >= needs_uV(self, expected_mA) / 2;
}
