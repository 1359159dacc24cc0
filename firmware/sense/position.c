#include "position.h"

void position_init(position_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz) {
    *self = (position_t){
        .step_q24 = (int32_t)((INT64_C(1000) << 24) / tick_rate_Hz),
        .leak_q30 = radians_a_tick_q32(cutoff_mHz, tick_rate_Hz) >> 2,
    };
}

void position_reset(position_t *self) {
    self->nm_q30 = 0;
}
