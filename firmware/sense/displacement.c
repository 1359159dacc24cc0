#include "displacement.h"

enum { POINTS_A_TICK = 2 };

void displacement_reset(displacement_t *self) {
    *self = (displacement_t){.point = DISPLACEMENT_POINTS};
}

void displacement_load(displacement_t *self, int32_t fundamental_nm, int32_t third_nm,
                       uint32_t phase_turn) {
    self->fundamental_nm = fundamental_nm;
    self->third_nm = third_nm;
    self->third_phase_turn = phase_turn;
    self->point = 0;
    self->peak_nm = 0;
}

static int32_t at(const displacement_t *self, uint32_t phase_turn) {
    const uint32_t third_turn = 3u * phase_turn + self->third_phase_turn;
    const int64_t sum_q25 = (int64_t)self->fundamental_nm * cos_linear_q25(phase_turn) +
                            (int64_t)self->third_nm * cos_linear_q25(third_turn);
    return (int32_t)clamp_i64(-(sum_q25 >> 25), -INT32_MAX, INT32_MAX);
}

static void search(displacement_t *self) {
    for (uint32_t i = 0; i < POINTS_A_TICK && self->point < DISPLACEMENT_POINTS; i++) {
        const int32_t size = abs_i32(at(self, self->point * (0x80000000u / DISPLACEMENT_POINTS)));
        self->peak_nm = size > self->peak_nm ? size : self->peak_nm;
        self->point++;
        if (self->point == DISPLACEMENT_POINTS) {
            self->half_peak_to_peak_nm = self->peak_nm;
        }
    }
}

int32_t displacement_step(displacement_t *self, uint32_t phase_turn) {
    search(self);
    return at(self, phase_turn);
}
