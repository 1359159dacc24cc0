#include "law_trial.h"

#include <stddef.h>
#include <string.h>

#include "crc32.h"
#include "force_bank.h"
#include "force_map.h"
#include "table.h"
#include "test_signal.h"
#include "view_signal.h"

enum {
    LONGEST_WAY_TICKS = 400,
    RATE_Hz = 1000,
    MOST_SPOILT = 4,
    QUIET,
    TONE,
    NOISE,
    STEPS,
    LIMITS,
    WAYS = LIMITS - QUIET + 1,
};

static uint32_t random_word(uint32_t *seed) {
    return ((uint32_t)signal_noise(seed, INT32_MAX) << 1) ^
           (uint32_t)signal_noise(seed, INT32_MAX) >> 7;
}

static uint32_t random_below(uint32_t *seed, uint32_t count) {
    return (uint32_t)((uint64_t)random_word(seed) * count >> 32);
}

// ---- tables -------------------------------------------------------------------------------------

void law_trial_seal(uint32_t *words, uint32_t count) {
    words[TABLE_WORDS] = count;
    words[TABLE_CRC] = crc32_words(&words[TABLE_WORDS], count - TABLE_WORDS);
}

static uint32_t spoilt(uint32_t word, uint32_t *seed) {
    static const uint32_t special[] = {
        0,          1,          2,          4,          20000,      0x00FFFFFF, 0x01000000,
        0x3FFFFFFF, 0x40000000, 0x7FFFFFFF, 0x80000000, 0xC0000001, 0xFF000001, 0xFFFFFFFF,
    };
    switch (random_below(seed, 5)) {
    case 0:
        return word ^ 1u << random_below(seed, 32);
    case 1:
        return special[random_below(seed, sizeof special / sizeof special[0])];
    case 2:
        return word + random_below(seed, 17) - 8u;
    case 3:
        return word * 2u;
    default:
        return random_word(seed) >> random_below(seed, 32);
    }
}

void law_trial_spoil(uint32_t *words, uint32_t count, uint32_t *seed) {
    for (uint32_t left = 1u + random_below(seed, MOST_SPOILT); left > 0; left--) {
        uint32_t *word = &words[TABLE_HEAD_WORDS + random_below(seed, count - TABLE_HEAD_WORDS)];
        *word = spoilt(*word, seed);
    }
    law_trial_seal(words, count);
}

// ---- what it sees -------------------------------------------------------------------------------

static uint32_t places_of(uint32_t quantity) {
    if (quantity == QUIESCE_SENSE_SUPPLY) {
        return 1;
    }
    return quiesce_sense_is_of_body((int32_t)quantity) ? QUIESCE_BODIES : QUIESCE_DAMPERS;
}

static law_trial_way_t draw_way(uint32_t *seed) {
    return (law_trial_way_t){
        .kind = QUIET + random_below(seed, WAYS),
        .size = VIEW_LIMIT >> random_below(seed, 31),
        .freq_mHz = 100u + random_below(seed, 100000),
    };
}

static int32_t value_of(const law_trial_way_t *way, uint32_t tick, uint32_t *seed) {
    switch (way->kind) {
    case TONE:
        return signal_sine(way->size, way->freq_mHz, tick, RATE_Hz);
    case NOISE:
        return signal_noise(seed, way->size);
    case STEPS:
        return (tick / 50u) % 2u == 0 ? way->size : -way->size;
    case LIMITS:
        return random_below(seed, 2) == 0 ? VIEW_LIMIT : -VIEW_LIMIT;
    default:
        return 0;
    }
}

static void look_at_signals(law_trial_t *self) {
    uint32_t number = 0;
    for (uint32_t quantity = 0; quantity < VIEW_SIGNAL_QUANTITIES; quantity++) {
        const view_quantity_t *one = &view_quantity[quantity];
        for (uint32_t at = 0; at < places_of(quantity); at++) {
            const int32_t value = value_of(&self->way[number++], self->tick, &self->seed);
            memcpy((char *)&self->view + one->offset + (size_t)one->stride * at, &value,
                   sizeof value);
        }
    }
}

// A lock that comes and goes, on a tone of the frequencies that parameters allow.
static void look_at_tone(law_trial_t *self, bool is_new) {
    view_tone_t *tone = &self->view.tone;
    if (is_new) {
        tone->step_turn = 400000u + random_below(&self->seed, 200000000);
        tone->freq_uHz = (int32_t)((uint64_t)tone->step_turn * RATE_Hz * 1000000u >> 32);
        tone->rms_um_s2 =
            (int32_t)(random_word(&self->seed) >> random_below(&self->seed, 31)) & VIEW_LIMIT;
        tone->body = random_below(&self->seed, QUIESCE_BODIES);
        self->view.is_at_rest = random_below(&self->seed, 8) == 0;
        self->view.is_output_on = random_below(&self->seed, 8) != 0;
        self->view.valid =
            random_below(&self->seed, 4) == 0 ? ~(VIEW_LOCK | VIEW_TONE) : ~UINT64_C(0);
    }
    tone->phase_turn += tone->step_turn;
}

void law_trial_look(law_trial_t *self) {
    const bool is_new = self->left_ticks == 0;
    if (is_new) {
        self->left_ticks = 1u + random_below(&self->seed, LONGEST_WAY_TICKS);
        for (uint32_t i = 0; i < LAW_TRIAL_SIGNALS; i++) {
            self->way[i] = draw_way(&self->seed);
        }
    }
    self->left_ticks--;
    look_at_signals(self);
    look_at_tone(self, is_new);
    self->tick++;
}

// ---- what it does -------------------------------------------------------------------------------

static bool take_table(law_trial_t *self, const uint32_t *table, uint32_t count) {
    const table_kind_t *kind = self->law->kind;
    if (kind == NULL) {
        return table == NULL;
    }
    self->setup.table = table != NULL ? table : kind->shipped;
    return self->setup.table != NULL &&
           (table == NULL || table_check(kind, table, count) == QUIESCE_TABLE_OK);
}

static bool take_map(law_trial_t *self, const uint32_t *map, uint32_t count) {
    const table_kind_t *kind = forces_kind(&self->forces);
    self->forces.table = map;
    return kind == NULL || (map != NULL && table_check(kind, map, count) == QUIESCE_TABLE_OK);
}

static void start_guards(law_trial_t *self, const quiesce_params_t *params) {
    const guard_cfg_t cfg = {
        .tick_rate_Hz = (uint32_t)params->tick_rate_Hz,
        .max_mA = params->max_current_mA,
        .safe_mA = params->safe_current_mA,
        .slew_mA_s = params->slew_mA_s,
    };
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        guard_init(&self->guard[i], &cfg);
    }
}

bool law_trial_start(law_trial_t *self, const quiesce_params_t *params, const uint32_t *table,
                     uint32_t count, const uint32_t *map, uint32_t map_count, uint32_t seed) {
    *self = (law_trial_t){
        .law = law_find(params->law),
        .setup = {.params = *params},
        .view = {.valid = ~UINT64_C(0), .is_output_on = true, .may_learn = true},
        .seed = seed,
    };
    forces_init(&self->forces, self->law, params);
    start_guards(self, params);
    if (!take_table(self, table, count) || !take_map(self, map, map_count)) {
        return false;
    }
    if (self->law->init != NULL) {
        self->law->init(self->state.law, &self->setup);
    }
    return true;
}

void law_trial_step(law_trial_t *self) {
    self->has_demand = self->law->step(self->state.law, &self->setup, &self->view, &self->demand);
    if (!self->has_demand) {
        law_demand_all(&self->demand, 0);
    }
    self->current = self->demand;
    if (self->has_demand && self->forces.track != NULL) {
        const forces_in_t in = {&self->setup.params, &self->view, QUIESCE_DAMPERS};
        forces_step(&self->forces, &self->state.force.track, &in, &self->current);
    }
}

void law_trial_guard(law_trial_t *self) {
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        self->command.value[i] = guard_step(&self->guard[i], self->current.value[i], true);
    }
}

static bool agrees(int32_t demand_mN, int32_t way) {
    return way == 0 || (demand_mN > 0) == (way > 0);
}

// A map of springs: it is the stroke alone that has to have the demand's sign.
static bool is_spring(const forces_t *forces, uint32_t damper) {
    return forces->track->kind != NULL && forces->track->kind->magic == FORCE_MAP_MAGIC &&
           (force_map_needs(forces->table) & VIEW_STROKE << damper) != 0;
}

// No model of the bank has a force of the demand's sign.
static bool is_against_bank(const law_trial_t *self, uint32_t i, int32_t demand_mN) {
    const uint32_t *section = force_bank_section(self->forces.table, i);
    const force_bank_t *bank = (const force_bank_t *)(const void *)self->state.force.track.of[i];
    bool is_against = true;
    for (uint32_t k = 0; section != NULL && k < force_bank_currents(section); k++) {
        const int32_t force_mN = force_bank_force_mN(bank, section, k, &self->view.damper[i]);
        is_against = is_against && (force_mN == 0 || !agrees(demand_mN, force_mN));
    }
    return is_against;
}

// Of all that the tracker looks at, force or velocity, nothing has the demand's sign.
static bool is_against(const law_trial_t *self, uint32_t i, int32_t demand_mN) {
    const forces_t *forces = &self->forces;
    if (forces_kind(forces) != NULL && forces_kind(forces)->magic == FORCE_BANK_MAGIC) {
        return is_against_bank(self, i, demand_mN);
    }
    const view_damper_t *damper = &self->view.damper[i];
    if (is_spring(forces, i)) {
        return !agrees(demand_mN, damper->stroke_nm);
    }
    const uint32_t *table = forces_kind(forces) != NULL ? forces->table : NULL;
    const uint64_t needs = (forces->track->needs | forces_table_needs(forces, table)) >> i;
    const bool sees_force = (needs & VIEW_FORCE) != 0;
    const bool sees_velocity = (needs & VIEW_STROKE_VELOCITY) != 0;
    return !(sees_force && agrees(demand_mN, damper->force_mN)) &&
           !(sees_velocity && agrees(demand_mN, damper->velocity_um_s));
}

static bool is_beyond(int32_t current_mA, int32_t most_mA) {
    return current_mA < 0 || current_mA > most_mA;
}

uint32_t law_trial_breaks(const law_trial_t *self) {
    const track_t *track = self->forces.track;
    uint32_t bits = 0;
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        const int32_t current_mA = self->current.value[i];
        const int32_t demand_mN = self->demand.value[i];
        if (is_beyond(self->command.value[i], self->setup.params.max_current_mA) ||
            (track != NULL && is_beyond(current_mA, QUIESCE_HIGHEST_CURRENT_mA))) {
            bits |= LAW_TRIAL_BEYOND;
        }
        if (track != NULL && current_mA > 0 && (demand_mN == 0 || is_against(self, i, demand_mN))) {
            bits |= LAW_TRIAL_ENERGISED;
        }
    }
    return bits;
}

uint32_t law_trial_state_bytes(const law_trial_t *self) {
    const uint8_t *bytes = (const uint8_t *)self->state.law;
    uint32_t used = self->forces.track != NULL ? LAW_FORCE_STATE_BYTES : LAW_STATE_BYTES;
    while (used > 0 && bytes[used - 1u] == 0) {
        used--;
    }
    return used;
}
