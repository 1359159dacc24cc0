// The paper's second stage (Table X), read incrementally: the current rises at a fixed rate while
// velocity and acceleration have equal signs and falls while they differ; polarity -1 reverses
// that. Optional leak back to the rule base's current. State in uA, so that slow rates and leaks
// add up.
#include "law_state.h"

static bool is_tuning(const quiesce_params_t *params, const law_in_t *in) {
    return in->freq_is_valid && in->freq_uHz / 1000 < params->selftune_upper_mHz;
}

static int32_t direction(const quiesce_params_t *params, const law_in_t *in) {
    if (abs_i32(in->accel_um_s2) < params->selftune_deadband_um_s2) {
        return 0;
    }
    return params->selftune_polarity * sign_i64(in->accel_um_s2) * sign_i64(in->velocity_um_s_q32);
}

// rate / tick rate in Q20, floor; rest < 4000, so that its product fits 32 bits.
static int64_t step_q20(const quiesce_params_t *params) {
    const uint32_t rate = (uint32_t)params->selftune_rate_mA_s;
    const uint32_t ticks = (uint32_t)params->tick_rate_Hz;
    return ((int64_t)(rate / ticks) << 20) + ((rate % ticks) << 20) / ticks;
}

// Backward Euler: any time constant is stable, the shortest ones included.
static int64_t leak_q20(const quiesce_params_t *params, int64_t excess_q20) {
    if (params->selftune_leak_ms == 0) {
        return 0;
    }
    const int64_t lag_milliticks = (int64_t)params->selftune_leak_ms * params->tick_rate_Hz;
    return excess_q20 * 1000 / (1000 + lag_milliticks);
}

static int32_t step(law_state_t *state, const quiesce_params_t *params, const law_in_t *in) {
    const int64_t base_q20 = (int64_t)in->base_mA << 20;
    if (!is_tuning(params, in)) {
        state->selftune_mA_q20 = base_q20;
        return in->base_mA;
    }
    const int64_t driven_q20 = state->selftune_mA_q20 + step_q20(params) * direction(params, in);
    const int64_t current_q20 = driven_q20 - leak_q20(params, driven_q20 - base_q20);
    state->selftune_mA_q20 = clamp_i64(current_q20, 0, (int64_t)params->max_current_mA << 20);
    return (int32_t)(state->selftune_mA_q20 >> 20);
}

const law_t law_fuzzy_selftune = {.name = "fuzzy_selftune", .step = step, .uses_rules = true};
