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

void control_init(control_t *self, const quiesce_params_t *params) {
    self->law = law_find(params->law);
    self->setup = (law_setup_t){
        .params = *params,
        .table = self->law->kind != NULL ? self->law->kind->shipped : NULL,
    };
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

void control_step(control_t *self, const view_t *view, law_demand_t *out) {
    const law_t *law = self->law;
    if ((view->valid & law->needs) != law->needs ||
        !law->step(self->state, &self->setup, view, out)) {
        law_demand_all(out, self->setup.params.unlock_current_mA);
    }
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
