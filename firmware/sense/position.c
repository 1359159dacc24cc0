#include "position.h"

#define LIMIT_nm 1073741823
#define LIMIT_q6 (POSITION_VELOCITY_LIMIT_um_s * 64 - 1)

void position_init(position_t *self, uint32_t tick_rate_Hz, int32_t cutoff_mHz) {
    *self = (position_t){
        .step_q24 = (int32_t)((INT64_C(1000) << 24) / tick_rate_Hz),
        .leak_q30 = (int32_t)(cutoff_mHz * TWO_PI_PER_MILLI_Q32 / tick_rate_Hz >> 2),
    };
}

void position_reset(position_t *self) {
    self->nm_q30 = 0;
}

int32_t position_step(position_t *self, int64_t velocity_um_s_q32) {
    // The high word alone tells whether it fits.
    const int32_t whole_um_s = (int32_t)(velocity_um_s_q32 >> 32);
    const int32_t fitting_q6 = (int32_t)(velocity_um_s_q32 >> 26);
    const int32_t velocity_q6 = whole_um_s >= POSITION_VELOCITY_LIMIT_um_s   ? LIMIT_q6
                                : whole_um_s < -POSITION_VELOCITY_LIMIT_um_s ? -LIMIT_q6
                                                                             : fitting_q6;
    const int32_t last_nm = (int32_t)(self->nm_q30 >> 30);
    // At most 2^30 x 2^25 more than 2^60.
    self->nm_q30 += (int64_t)velocity_q6 * self->step_q24 - (int64_t)last_nm * self->leak_q30;
    const int32_t nm = (int32_t)(self->nm_q30 >> 30);
    if (nm > LIMIT_nm || nm < -LIMIT_nm) {
        self->nm_q30 = (nm > 0 ? INT64_C(1) : INT64_C(-1)) * LIMIT_nm * (INT64_C(1) << 30);
        return nm > 0 ? LIMIT_nm : -LIMIT_nm;
    }
    return nm;
}
