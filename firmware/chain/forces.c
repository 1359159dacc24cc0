#include "forces.h"

#include <stddef.h>

static const track_t *tracker_of(const law_t *law, const quiesce_params_t *params) {
    return law->demands == LAW_DEMANDS_FORCE ? track_find(params->tracker) : NULL;
}

uint64_t forces_need(const law_t *law, const quiesce_params_t *params) {
    const track_t *track = tracker_of(law, params);
    return track != NULL ? track->needs : 0;
}

bool forces_may_need_more(const law_t *law, const quiesce_params_t *params) {
    const track_t *track = tracker_of(law, params);
    return track != NULL && track->kind != NULL && track->kind->needs != NULL;
}

void forces_init(forces_t *self, const law_t *law, const quiesce_params_t *params) {
    *self = (forces_t){.track = tracker_of(law, params)};
}

const table_kind_t *forces_kind(const forces_t *self) {
    return self->track != NULL ? self->track->kind : NULL;
}

void forces_use(forces_t *self, forces_state_t *state, const uint32_t *table) {
    self->table = table;
    *state = (forces_state_t){0};
}

uint64_t forces_table_needs(const forces_t *self, const uint32_t *table) {
    const table_kind_t *kind = forces_kind(self);
    return table != NULL && kind->needs != NULL ? kind->needs(table) : 0;
}

bool forces_are_ready(const forces_t *self) {
    return self->track == NULL || self->track->kind == NULL || self->table != NULL;
}

void forces_step(const forces_t *self, forces_state_t *state, const forces_in_t *in,
                 law_demand_t *demand) {
    track_setup_t setup = {in->params, self->table, 0};
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        const int32_t demand_mN = demand->value[i];
        setup.damper = i;
        demand->value[i] = i < in->dampers ? self->track->step(state->of[i], &setup,
                                                               &in->view->damper[i], demand_mN)
                                           : 0;
    }
}
