#include "control.h"

#include <stddef.h>

#include "at_start.h"
#include "table.h"

// Of what a law needs that demands forces, or lacks its table: a bit that no view has. Such a law
// fails the first test of a tick, and the others do not pay for a second one.
#define MORE (UINT64_C(1) << 63)

static uint64_t control_needs(const quiesce_params_t *params) {
    const law_t *law = law_find(params->law);
    return law->needs | forces_need(law, params);
}

uint64_t control_serves(const quiesce_params_t *params) {
    const law_t *law = law_find(params->law);
    const bool may_need_more =
        (law->kind != NULL && law->kind->needs != NULL) || forces_may_need_more(law, params);
    return may_need_more ? ~UINT64_C(0) : control_needs(params);
}

// The law, from rest. One that demands forces shares its memory with the tracker, which goes on.
static void start(control_t *self) {
    const uint32_t bytes =
        self->forces.track != NULL ? sizeof self->state.force.law : sizeof self->state.law;
    for (uint32_t i = 0; i < bytes / sizeof self->state.law[0]; i++) {
        self->state.law[i] = 0;
    }
    if (self->law->init != NULL) {
        self->law->init(self->state.law, &self->setup);
    }
}

enum { OF_BODIES, OF_DAMPERS, OF_BOARD };

// In the order of signal_name.
static const struct {
    uint8_t first_bit; ///< of a view's valid
    uint8_t owner;
} signals[] = {
    {QUIESCE_VALID_ACCEL, OF_BODIES},
    {QUIESCE_VALID_VELOCITY, OF_BODIES},
    {QUIESCE_VALID_DISPLACEMENT, OF_BODIES},
    {QUIESCE_VALID_STROKE, OF_DAMPERS},
    {QUIESCE_VALID_STROKE_VELOCITY, OF_DAMPERS},
    {QUIESCE_VALID_FORCE, OF_DAMPERS},
    {QUIESCE_VALID_CURRENT, OF_DAMPERS},
    {QUIESCE_VALID_VOLTAGE, OF_DAMPERS},
    {QUIESCE_VALID_TEMPERATURE, OF_DAMPERS},
    {QUIESCE_VALID_SUPPLY, OF_BOARD},
};

#define SIGNALS (sizeof signals / sizeof signals[0])

// By themselves: a program that asks for no name does without them.
static const char *const signal_name[SIGNALS] = {
    "acceleration", "velocity", "displacement", "stroke",      "stroke velocity",
    "force",        "current",  "coil voltage", "temperature", "supply voltage",
};

static uint64_t quantity_of(uint32_t i) {
    return UINT64_C(1) << signals[i].first_bit;
}

// A bit for each of those that there are.
static uint64_t bits_of(uint32_t owner, uint32_t bodies, uint32_t dampers) {
    if (QUIESCE_BODIES == 1 && QUIESCE_DAMPERS == 1) {
        return 1;
    }
    return (UINT64_C(1) << (owner == OF_BODIES ? bodies : dampers)) - 1u;
}

// What a law needs where these bodies and dampers are: VIEW_EACH is each of them.
static uint64_t needs_there(uint64_t needs, uint32_t bodies, uint32_t dampers) {
    for (uint32_t i = 0; i < SIGNALS; i++) {
        const uint64_t each = VIEW_EACH(quantity_of(i));
        const uint64_t present = quantity_of(i) * bits_of(signals[i].owner, bodies, dampers);
        if (signals[i].owner != OF_BOARD && (needs & each) == each) {
            needs &= ~each | present;
        }
    }
    return needs;
}

// The signal of bit number index among those that are set. Returns false iff there are fewer.
static bool find_signal(uint64_t bits, uint32_t index, quiesce_signal_t *found) {
    for (uint32_t i = 0; i < SIGNALS; i++) {
        const bool is_one = signals[i].owner == OF_BOARD;
        for (int32_t at = 0; at < (is_one ? 1 : 4); at++) {
            if ((bits & quantity_of(i) << at) != 0 && index-- == 0) {
                *found = (quiesce_signal_t){signal_name[i], is_one ? -1 : at};
                return true;
            }
        }
    }
    return false;
}

bool quiesce_missing(const quiesce_board_t *board, const quiesce_params_t *params,
                     quiesce_signal_t *missing) {
    places_t places;
    if (law_find(params->law) == NULL) {
        return false;
    }
    places_init(&places, board);
    return find_signal(needs_there(control_needs(params), places.bodies, places.dampers) &
                           ~places_provide(&places),
                       0, missing);
}

bool quiesce_provided(const quiesce_board_t *board, uint32_t index, quiesce_signal_t *provided) {
    places_t places;
    places_init(&places, board);
    return find_signal(places_provide(&places), index, provided);
}

// A law works with a table, and there is none.
static bool lacks_table(const control_t *self) {
    return self->law->kind != NULL && self->setup.table == NULL;
}

const char *control_lacks_table(const control_t *self) {
    if (lacks_table(self)) {
        return self->law->name;
    }
    return forces_are_ready(&self->forces) ? NULL : self->forces.track->name;
}

// What words of the tracker's kind need, none of NULL, where these bodies and dampers are.
static uint64_t force_table_needs(const control_t *self, const uint32_t *words) {
    return needs_there(forces_table_needs(&self->forces, words), self->bodies, self->dampers);
}

static void find_needs(control_t *self) {
    const table_kind_t *kind = self->law->kind;
    const bool has_own = kind != NULL && kind->needs != NULL && self->setup.table != NULL;
    const bool wants_more = self->forces.track != NULL || lacks_table(self);
    self->needs = self->fixed_needs | (has_own ? kind->needs(self->setup.table) : 0) |
                  force_table_needs(self, self->forces.table) | (wants_more ? MORE : 0);
}

AT_START void control_init(control_t *self, const places_t *places,
                           const quiesce_params_t *params) {
    self->law = law_find(params->law);
    forces_init(&self->forces, self->law, params);
    self->bodies = places->bodies;
    self->dampers = places->dampers;
    self->fixed_needs = needs_there(control_needs(params), places->bodies, places->dampers);
    self->provided = places_provide(places);
    self->setup.params = *params;
    self->setup.table = self->law->kind != NULL ? self->law->kind->shipped : NULL;
    self->blind_ticks = 0;
    self->blind_most_ticks = ticks_in_ms(CONTROL_BLIND_ms, params->tick_rate_Hz);
    find_needs(self);
    self->state.force.track = (forces_state_t){0};
    start(self);
}

static void use_force_table(control_t *self, const uint32_t *words) {
    forces_use(&self->forces, &self->state.force.track, words);
    find_needs(self);
}

static void use_law_table(control_t *self, const uint32_t *words) {
    self->setup.table = words;
    find_needs(self);
    if (self->law->retable != NULL) {
        self->law->retable(self->state.law, &self->setup);
    } else {
        start(self);
    }
}

static const table_kind_t *kind_of(const control_t *self, quiesce_owner_t owner) {
    return owner == QUIESCE_OF_LAW ? self->law->kind : forces_kind(&self->forces);
}

static void use_table(control_t *self, quiesce_owner_t owner, const uint32_t *words) {
    if (owner == QUIESCE_OF_LAW) {
        use_law_table(self, words);
    } else {
        use_force_table(self, words);
    }
}

bool control_drop(control_t *self, quiesce_owner_t owner) {
    const table_kind_t *kind = kind_of(self, owner);
    if (kind != NULL) {
        use_table(self, owner, kind->shipped);
    }
    return kind != NULL;
}

const uint32_t *control_table(const control_t *self, quiesce_owner_t owner) {
    return owner == QUIESCE_OF_LAW ? self->setup.table : self->forces.table;
}

// Whose words are; the law's where they are nobody's.
static quiesce_owner_t owner_of(const control_t *self, const uint32_t *words, uint32_t count) {
    const table_kind_t *map = forces_kind(&self->forces);
    return map != NULL && count > 0 && words[TABLE_MAGIC] == map->magic ? QUIESCE_OF_TRACKER
                                                                        : QUIESCE_OF_LAW;
}

// Each of a tracker's table is each that there is; a law's says which ones.
static bool is_served(const control_t *self, quiesce_owner_t owner, const uint32_t *words) {
    const table_kind_t *kind = kind_of(self, owner);
    const uint64_t needs = kind->needs != NULL ? kind->needs(words) : 0;
    const uint64_t there =
        owner == QUIESCE_OF_TRACKER ? needs_there(needs, self->bodies, self->dampers) : needs;
    return (there & ~self->provided) == 0;
}

static bool is_of_this_rate(const control_t *self, const table_kind_t *kind,
                            const uint32_t *words) {
    const uint32_t made_for_Hz = kind->rate_Hz != NULL ? kind->rate_Hz(words) : TABLE_ANY_RATE;
    return made_for_Hz == TABLE_ANY_RATE ||
           made_for_Hz == (uint32_t)self->setup.params.tick_rate_Hz;
}

AT_START quiesce_table_verdict_t control_check(const control_t *self, const uint32_t *words,
                                               uint32_t count, bool is_summed) {
    const quiesce_owner_t owner = owner_of(self, words, count);
    const table_kind_t *kind = kind_of(self, owner);
    if (kind == NULL) {
        return QUIESCE_TABLE_MAGIC;
    }
    const quiesce_table_verdict_t verdict =
        is_summed ? table_check_summed(kind, words, count) : table_check(kind, words, count);
    if (verdict != QUIESCE_TABLE_OK) {
        return verdict;
    }
    return is_served(self, owner, words) && is_of_this_rate(self, kind, words) ? QUIESCE_TABLE_OK
                                                                               : QUIESCE_TABLE_FIT;
}

void control_use(control_t *self, const uint32_t *words) {
    use_table(self, owner_of(self, words, words[TABLE_WORDS]), words);
}

static bool has_all(const control_t *self, uint64_t valid) {
    return (valid & self->needs) == self->needs;
}

bool control_sees(const control_t *self, const view_t *view) {
    const bool is_ready = !lacks_table(self) && forces_are_ready(&self->forces);
    return has_all(self, view->valid | (is_ready ? MORE : 0));
}

static bool ask(control_t *self, const view_t *view, law_demand_t *out) {
    return self->law->step(self->state.law, &self->setup, view, out);
}

static bool ask_more(control_t *self, const view_t *view, law_demand_t *out) {
    if (!control_sees(self, view) || !ask(self, view, out)) {
        return false;
    }
    if (self->forces.track != NULL) {
        const forces_in_t in = {&self->setup.params, view, self->dampers};
        forces_step(&self->forces, &self->state.force.track, &in, out);
    }
    return true;
}

bool control_step(control_t *self, const view_t *view, law_demand_t *out) {
    if ((has_all(self, view->valid) && ask(self, view, out)) ||
        ((self->needs & MORE) != 0 && ask_more(self, view, out))) {
        self->blind_ticks = 0;
        return true;
    }
    law_demand_all(out, law_unlock_mA(&self->setup.params, view));
    self->blind_ticks = view->is_output_on ? increment_sat_u32(self->blind_ticks) : 0u;
    return self->blind_ticks <= self->blind_most_ticks;
}

void control_report(const control_t *self, int32_t word[QUIESCE_REPORT_WORDS]) {
    for (uint32_t i = 0; i < QUIESCE_REPORT_WORDS; i++) {
        word[i] = 0;
    }
    if (self->law->report != NULL) {
        self->law->report(self->state.law, &self->setup, word);
    }
}

bool control_save(const control_t *self, quiesce_learnt_t *out) {
    *out = (quiesce_learnt_t){0};
    if (self->law->save != NULL) {
        out->count = self->law->save(self->state.law, &self->setup, out->words);
    }
    return out->count != 0;
}

bool control_load(control_t *self, const quiesce_learnt_t *in) {
    const uint32_t count = in == NULL ? 0 : in->count;
    if (self->law->load == NULL || count > QUIESCE_LEARNT_MAX_WORDS || (in != NULL && count == 0)) {
        return in == NULL;
    }
    return self->law->load(self->state.law, &self->setup, in == NULL ? NULL : in->words, count);
}

uint32_t control_table_hash(const control_t *self) {
    const uint32_t *const table =
        self->setup.table != NULL ? self->setup.table : self->forces.table;
    return table != NULL ? table[TABLE_CRC] : 0u;
}
