// The paper's second stage (Table X), read incrementally: the current rises at a fixed rate while
// velocity and acceleration have equal signs and falls while they differ; polarity -1 reverses
// that. Optional leak back to the rule base's current. State in uA, so that slow rates and leaks
// add up.
#include "law.h"

static bool is_tuning(const quiesce_params_t *params, const law_in_t *in) {
    return in->freq_is_valid && in->freq_uHz / 1000 < params->selftune_upper_mHz;
}

static int32_t direction(const quiesce_params_t *params, const law_in_t *in) {
    if (abs_i32(in->accel_um_s2) < params->selftune_deadband_um_s2) {
        return 0;
    }
    return params->selftune_polarity * sign_i64(in->accel_um_s2) * sign_i64(in->velocity_um_s_q32);
}

// rate x 1000 / tick rate, floor, without leaving 32 bits.
static int32_t step_uA(const quiesce_params_t *params) {
    const int32_t whole = params->selftune_rate_mA_s / params->tick_rate_Hz;
    const int32_t rest = params->selftune_rate_mA_s % params->tick_rate_Hz;
    return whole * 1000 + rest * 1000 / params->tick_rate_Hz;
}

static int64_t leak_uA(const quiesce_params_t *params, int64_t excess_uA) {
    if (params->selftune_leak_ms == 0) {
        return 0;
    }
    return excess_uA * 1000 / ((int64_t)params->selftune_leak_ms * params->tick_rate_Hz);
}

static int32_t step(law_state_t *state, const quiesce_params_t *params, const law_in_t *in) {
    const int32_t base_uA = in->base_mA * 1000;
    if (!is_tuning(params, in)) {
        state->current_uA = base_uA;
        return in->base_mA;
    }
    const int64_t current_uA = state->current_uA +
                               (int64_t)step_uA(params) * direction(params, in) -
                               leak_uA(params, (int64_t)state->current_uA - base_uA);
    state->current_uA = (int32_t)clamp_i64(current_uA, 0, params->max_current_mA * INT64_C(1000));
    return state->current_uA / 1000;
}

const law_t law_fuzzy_selftune = {"fuzzy_selftune", step};
