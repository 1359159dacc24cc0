// The paper's second stage (Table X), read incrementally: the current rises at a fixed rate while
// velocity and acceleration have equal signs and falls while they differ; polarity -1 reverses
// that. Optional leak back to the rule base's current. State in uA, so that slow rates and leaks
// add up. The signs are those of the body that is tracked.
#include "selftune_state.h"

#include <stddef.h>

_Static_assert(sizeof(selftune_t) <= LAW_STATE_BYTES, "the arena is too small");
_Static_assert(offsetof(selftune_t, rules) == 0, "it begins with the rules");

static bool is_tuning(const quiesce_params_t *params, const view_t *view) {
    return (view->valid & VIEW_TONE) != 0 &&
           view->tone.freq_uHz / 1000 < params->selftune_upper_mHz;
}

static int32_t direction(const quiesce_params_t *params, const view_body_t *body) {
    if (abs_i32(body->accel_um_s2) < params->selftune_deadband_um_s2) {
        return 0;
    }
    return params->selftune_polarity * sign_i64(body->accel_um_s2) * sign_i64(body->velocity_um_s);
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

// In mA, Q20.
static int64_t tuned_q20(const selftune_t *self, const quiesce_params_t *params,
                         const view_body_t *body, int64_t base_q20) {
    const int64_t driven_q20 = self->current_mA_q20 + step_q20(params) * direction(params, body);
    const int64_t current_q20 = driven_q20 - leak_q20(params, driven_q20 - base_q20);
    return clamp_i64(current_q20, 0, (int64_t)params->max_current_mA << 20);
}

// Which body is tracked is known in a tick only: a need of the law cannot name it. Without its
// motion the rules' current goes on.
static bool sees_motion(const view_t *view) {
    return (view->valid & VIEW_VELOCITY << view->tone.body) != 0;
}

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    selftune_t *self = state;
    const quiesce_params_t *params = &setup->params;
    const int32_t rules_mA = rule_base_step(&self->rules, setup->table, &view->tone);
    const int64_t base_q20 = (int64_t)rule_base_or_unlock_mA(setup, view, rules_mA) << 20;
    // With the output off the structure answers to nothing: there is nothing to tune by.
    self->current_mA_q20 = view->is_output_on && is_tuning(params, view) && sees_motion(view)
                               ? tuned_q20(self, params, &view->body[view->tone.body], base_q20)
                               : base_q20;
    law_demand_all(out, (int32_t)(self->current_mA_q20 >> 20));
    return true;
}

extern const law_t law_fuzzy_selftune;
const law_t law_fuzzy_selftune = {
    .name = "fuzzy_selftune",
    .needs = VIEW_RMS,
    .kind = &rule_base_kind,
    .reports = rule_base_reports,
    .retable = rule_base_retable, // the tuned current goes on
    .step = step,
    .report = rule_base_report,
};
