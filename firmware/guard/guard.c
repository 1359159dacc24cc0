#include "guard.h"

#include "quiesce_board.h"

void guard_init(guard_t *self, const guard_cfg_t *cfg) {
    self->max_mA = clamp_i32(cfg->max_mA, 0, QUIESCE_HIGHEST_CURRENT_mA);
    self->safe_mA = clamp_i32(cfg->safe_mA, 0, self->max_mA);
    const int64_t slew_uA = (int64_t)cfg->slew_mA_s * 1000 / cfg->tick_rate_Hz;
    self->slew_uA = (int32_t)clamp_i64(slew_uA, 1, QUIESCE_HIGHEST_CURRENT_mA * INT64_C(1000));
    self->last_uA = self->safe_mA * 1000;
}

int32_t guard_step(guard_t *self, int32_t request_mA, bool is_allowed) {
    if (!is_allowed) {
        self->last_uA = self->safe_mA * 1000;
        return self->safe_mA;
    }
    const int32_t wanted_uA = clamp_i32(request_mA, 0, self->max_mA) * 1000;
    self->last_uA =
        clamp_i32(wanted_uA, self->last_uA - self->slew_uA, self->last_uA + self->slew_uA);
    return self->last_uA / 1000;
}
