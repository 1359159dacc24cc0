#include "displacement.h"

void displacement_reset(displacement_t *self) {
    *self = (displacement_t){.span = {.point = HARMONIC_SPAN_POINTS}};
}

void displacement_load(displacement_t *self, int32_t fundamental_nm, int32_t third_nm,
                       uint32_t phase_turn) {
    harmonic_span_start(&self->span, fundamental_nm, third_nm, phase_turn);
}

int32_t displacement_step(displacement_t *self, uint32_t phase_turn) {
    if (harmonic_span_step(&self->span)) {
        self->half_peak_to_peak_nm = self->span.largest;
    }
    return -harmonic_span_at(&self->span, phase_turn);
}
