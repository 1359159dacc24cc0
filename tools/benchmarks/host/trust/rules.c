#include "rules.h"

const char *const rule_names[RULES] = {"range", "slew",  "safe",  "driver",
                                       "stop",  "latch", "arming"};

void rules_start(rules_t *self, const rig_t *rig) {
    self->rig = rig;
    self->last = (quiesce_out_t){0};
    self->last_enable = true; // what is held from the start on is no edge
    self->last_reset = true;
    self->is_armed = false;
    self->has_ticked = false;
}

static bool breaks_range(const rules_t *self, const quiesce_out_t *out) {
    const uint32_t dampers = rig_dampers(self->rig);
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        const int32_t cmd_mA = out->damper[i].current_cmd_mA;
        const int32_t limit_mA = i < dampers ? rig_limit_mA(self->rig, i) : 0;
        if (cmd_mA < 0 || cmd_mA > limit_mA || (i >= dampers && out->damper[i].driver_enable)) {
            return true;
        }
    }
    return false;
}

// From the safe current on, of which the guard begins.
static bool breaks_slew(const rules_t *self, const quiesce_out_t *out) {
    if (!rules_is_running(out->telemetry.state)) {
        return false;
    }
    const quiesce_params_t *p = &self->rig->params;
    const int64_t slew_uA = (int64_t)p->slew_mA_s * 1000 / p->tick_rate_Hz;
    const int64_t most_mA = slew_uA / 1000 + 1;
    for (uint32_t i = 0; i < rig_dampers(self->rig); i++) {
        const int64_t from_mA = rules_is_running(self->last.telemetry.state)
                                    ? self->last.damper[i].current_cmd_mA
                                    : rig_safe_mA(self->rig, i);
        const int64_t change_mA = out->damper[i].current_cmd_mA - from_mA;
        if (change_mA > most_mA || -change_mA > most_mA) {
            return true;
        }
    }
    return false;
}

static bool breaks_safe(const rules_t *self, const quiesce_out_t *out) {
    if (rules_is_running(out->telemetry.state)) {
        return false;
    }
    for (uint32_t i = 0; i < rig_dampers(self->rig); i++) {
        if (out->damper[i].current_cmd_mA != rig_safe_mA(self->rig, i)) {
            return true;
        }
    }
    return false;
}

static bool has_failed(const rules_t *self, const quiesce_in_t *in) {
    bool has_failed = false;
    for (uint32_t i = 0; i < rig_dampers(self->rig); i++) {
        has_failed = has_failed || in->driver[i].has_failed;
    }
    return has_failed;
}

static bool breaks_driver(const rules_t *self, const quiesce_in_t *in, const quiesce_out_t *out) {
    const bool is_off =
        in->estop || has_failed(self, in) || out->telemetry.state == QUIESCE_STATE_FAULT;
    for (uint32_t i = 0; i < rig_dampers(self->rig); i++) {
        if (is_off && out->damper[i].driver_enable) {
            return true;
        }
    }
    return false;
}

static bool breaks_stop(const quiesce_in_t *in, const quiesce_out_t *out) {
    const quiesce_telemetry_t *t = &out->telemetry;
    return in->estop && (t->state != QUIESCE_STATE_FAULT ||
                         (t->fault != QUIESCE_FAULT_ESTOP && t->fault != QUIESCE_FAULT_PARAMETER));
}

static bool breaks_latch(const rules_t *self, const quiesce_in_t *in, const quiesce_out_t *out) {
    const bool was_latched = self->has_ticked && self->last.telemetry.state == QUIESCE_STATE_FAULT;
    if (!was_latched || out->telemetry.state == QUIESCE_STATE_FAULT) {
        return false;
    }
    const bool is_edge = in->fault_reset && !self->last_reset;
    return !is_edge || in->estop || has_failed(self, in) ||
           self->last.telemetry.fault == QUIESCE_FAULT_PARAMETER;
}

static bool breaks_arming(const rules_t *self, const quiesce_out_t *out) {
    return rules_is_running(out->telemetry.state) && !self->is_armed;
}

static void note_edge(rules_t *self, const quiesce_in_t *in, const quiesce_out_t *out) {
    if (in->estop || out->telemetry.state == QUIESCE_STATE_FAULT) {
        self->is_armed = false;
    } else if (in->enable && !self->last_enable) {
        self->is_armed = true;
    }
}

static void note(rules_t *self, const quiesce_in_t *in, const quiesce_out_t *out) {
    const uint32_t last = self->has_ticked ? self->last.telemetry.state : QUIESCE_STATE_INIT;
    const uint32_t state = out->telemetry.state;
    self->ticks++;
    self->running_ticks += rules_is_running(state) ? 1u : 0u;
    self->starts += rules_is_running(state) && !rules_is_running(last) ? 1u : 0u;
    self->stops += state == QUIESCE_STATE_FAULT && last != QUIESCE_STATE_FAULT ? 1u : 0u;
    self->last = *out;
    self->last_enable = in->enable;
    self->last_reset = in->fault_reset;
    self->has_ticked = true;
}

rule_t rules_tick(rules_t *self, const quiesce_in_t *in, const quiesce_out_t *out) {
    note_edge(self, in, out);
    const bool is_broken[RULES] = {
        [RULE_RANGE] = breaks_range(self, out),   [RULE_SLEW] = breaks_slew(self, out),
        [RULE_SAFE] = breaks_safe(self, out),     [RULE_DRIVER] = breaks_driver(self, in, out),
        [RULE_STOP] = breaks_stop(in, out),       [RULE_LATCH] = breaks_latch(self, in, out),
        [RULE_ARMING] = breaks_arming(self, out),
    };
    rule_t first = RULES;
    for (uint32_t i = RULES; i-- > 0;) {
        self->broken[i] += is_broken[i] ? 1u : 0u;
        first = is_broken[i] ? (rule_t)i : first;
    }
    note(self, in, out);
    return first;
}
