#include "energy.h"

#define SECONDS 4u

void energy_init(energy_t *self, uint32_t tick_rate_Hz) {
    *self = (energy_t){.shift = 64u - leading_zeros_u64(tick_rate_Hz - 1u)};
}

void energy_forget(energy_t *self) {
    self->taken = 0;
    self->moved = 0;
    self->ticks = 0;
}

bool energy_is_negative(energy_t *self, int32_t force_mN, int32_t velocity_um_s, bool are_valid) {
    if (!are_valid) {
        if (self->moved != 0) {
            energy_forget(self);
        }
        return false;
    }
    const int64_t power = (int64_t)force_mN * velocity_um_s >> 10;
    const int64_t magnitude = power < 0 ? -power : power;
    self->taken += (power - self->taken) / (INT64_C(1) << self->shift);
    self->moved += (magnitude - self->moved) / (INT64_C(1) << self->shift);
    const bool is_negative = self->taken < -self->moved / 2;
    self->ticks = is_negative ? increment_sat_u32(self->ticks) : 0u;
    return self->ticks >= SECONDS << self->shift;
}
