#include "motion.h"

#define VELOCITY_LIMIT_q32 (INT64_C(1073741823) << 32)

void motion_init(motion_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz) {
    *self = (motion_t){
        .step_q32 = (INT64_C(1) << 32) / tick_rate_Hz,
        .leak_q32 = cutoff_mHz * TWO_PI_PER_MILLI_Q32 / tick_rate_Hz,
    };
}

void motion_reset(motion_t *self) {
    self->velocity_um_s_q32 = 0;
}

int64_t motion_step(motion_t *self, int32_t accel_um_s2) {
    const int64_t gain = accel_um_s2 * self->step_q32;
    const int64_t loss = motion_velocity_um_s(self->velocity_um_s_q32) * self->leak_q32;
    self->velocity_um_s_q32 =
        clamp_i64(self->velocity_um_s_q32 + gain - loss, -VELOCITY_LIMIT_q32, VELOCITY_LIMIT_q32);
    return self->velocity_um_s_q32;
}
