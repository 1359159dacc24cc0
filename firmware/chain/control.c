#include "control.h"

#include <stddef.h>

static void start(control_t *self) {
    for (uint32_t i = 0; i < sizeof self->state / sizeof self->state[0]; i++) {
        self->state[i] = 0;
    }
    if (self->law->init != NULL) {
        self->law->init(self->state, &self->setup);
    }
}

// A need of every body or damper is one of those that there are.
static uint64_t limited(uint64_t needs, uint64_t quantity, uint32_t count) {
    const uint64_t each = VIEW_EACH(quantity);
    const uint64_t beyond = each & ~(quantity * ((UINT64_C(1) << count) - 1u));
    return (needs & each) == each ? needs & ~beyond : needs;
}

uint64_t needs_there(uint64_t needs, const places_t *places) {
    static const uint64_t of_bodies[] = {VIEW_ACCEL, VIEW_VELOCITY, VIEW_DISPLACEMENT};
    static const uint64_t of_dampers[] = {VIEW_STROKE,  VIEW_STROKE_VELOCITY, VIEW_FORCE,
                                          VIEW_CURRENT, VIEW_VOLTAGE,         VIEW_TEMPERATURE};
    for (uint32_t i = 0; i < sizeof of_bodies / sizeof of_bodies[0]; i++) {
        needs = limited(needs, of_bodies[i], places->bodies);
    }
    for (uint32_t i = 0; i < sizeof of_dampers / sizeof of_dampers[0]; i++) {
        needs = limited(needs, of_dampers[i], places->dampers);
    }
    return needs;
}

void control_init(control_t *self, const places_t *places, const quiesce_params_t *params) {
    self->law = law_find(params->law);
    self->needs = needs_there(self->law->needs, places);
    self->setup = (law_setup_t){
        .params = *params,
        .table = self->law->kind != NULL ? self->law->kind->shipped : NULL,
    };
    self->blind_ticks = 0;
    self->blind_most_ticks = ticks_in_ms(CONTROL_BLIND_ms, params->tick_rate_Hz);
    start(self);
}

quiesce_table_verdict_t control_use(control_t *self, const uint32_t *words, uint32_t count) {
    const law_table_kind_t *kind = self->law->kind;
    if (kind == NULL || (words == NULL && kind->shipped == NULL)) {
        return QUIESCE_TABLE_MAGIC;
    }
    const quiesce_table_verdict_t verdict =
        words == NULL ? QUIESCE_TABLE_OK : kind->check(words, count);
    if (verdict != QUIESCE_TABLE_OK) {
        return verdict;
    }
    self->setup.table = words == NULL ? kind->shipped : words;
    if (self->law->retable != NULL) {
        self->law->retable(self->state, &self->setup);
    } else {
        start(self);
    }
    return QUIESCE_TABLE_OK;
}

bool control_sees(const control_t *self, const view_t *view) {
    return (view->valid & self->needs) == self->needs;
}

bool control_step(control_t *self, const view_t *view, law_demand_t *out) {
    if (control_sees(self, view) && self->law->step(self->state, &self->setup, view, out)) {
        self->blind_ticks = 0;
        return true;
    }
    law_demand_all(out, self->setup.params.unlock_current_mA);
    self->blind_ticks = view->is_output_on ? increment_sat_u32(self->blind_ticks) : 0u;
    return self->blind_ticks <= self->blind_most_ticks;
}

void control_report(const control_t *self, int32_t word[QUIESCE_REPORT_WORDS]) {
    for (uint32_t i = 0; i < QUIESCE_REPORT_WORDS; i++) {
        word[i] = 0;
    }
    if (self->law->report != NULL) {
        self->law->report(self->state, &self->setup, word);
    }
}

bool control_save(const control_t *self, quiesce_learnt_t *out) {
    *out = (quiesce_learnt_t){0};
    if (self->law->save != NULL) {
        out->count = self->law->save(self->state, &self->setup, out->words);
    }
    return out->count != 0;
}

bool control_load(control_t *self, const quiesce_learnt_t *in) {
    const uint32_t count = in == NULL ? 0 : in->count;
    if (self->law->load == NULL || count > QUIESCE_LEARNT_MAX_WORDS || (in != NULL && count == 0)) {
        return in == NULL;
    }
    return self->law->load(self->state, &self->setup, in == NULL ? NULL : in->words, count);
}
