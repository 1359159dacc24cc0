#include "motion.h"

void motion_init(motion_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz) {
    *self = (motion_t){
        .step_q32 = (int32_t)(UINT32_MAX / tick_rate_Hz),
        .leak_q32 = radians_a_tick_q32(cutoff_mHz, tick_rate_Hz),
    };
}

void motion_reset(motion_t *self) {
    self->velocity_um_s_q32 = 0;
}
