// A current for each pattern of signs: skyhook and groundhook on and off, ADD and SH-ADD, bang-bang
// and quasi-bang-bang, Lyapunov's, largest dissipation.
//
// Its table, after the head of all tables: sections, one a damper from the first on. A section:
// inputs m, signs s, idle current; m inputs (view_signal.h); s combinations {band, shift of the
// band, m coefficients below 2^24}; 2^s currents in mA. Sign j is on where the sum of coefficients
// x inputs is above band x 2^shift, off where it is below -band x 2^shift, else it stays. The
// current is number sum of 2^j of the signs that are on; until each has been decided once, and at
// rest, the idle one. Sums are below 2^58. `quiesce law make` writes them.
#include "fixq.h"
#include "law.h"
#include "sections.h"
#include "state_space.h"
#include "view_signal.h"

#define SIGNS_MAGIC UINT32_C(0x31475351)

enum { MOST_INPUTS = 6, MOST_SIGNS = 4, MOST_SHIFT = 40 };

typedef struct {
    uint32_t inputs;
    uint32_t signs;
    uint32_t idle_mA;
    view_input_t input[];
} section_t;

enum { SECTION_WORDS = 3 };

typedef struct {
    int32_t band;
    uint32_t shift;
    int32_t coefficient[];
} combination_t;

enum { COMBINATION_WORDS = 2 };

typedef struct {
    uint8_t known;
    uint8_t on;
} signs_t;

static uint32_t words_in(const section_t *section) {
    return SECTION_WORDS + VIEW_INPUT_WORDS * section->inputs +
           section->signs * (COMBINATION_WORDS + section->inputs) + (1u << section->signs);
}

static const section_t *after(const section_t *section) {
    return (const section_t *)(const void *)((const uint32_t *)(const void *)section +
                                             words_in(section));
}

static const combination_t *combination_of(const section_t *section, uint32_t i) {
    const uint32_t *first = (const uint32_t *)(const void *)&section->input[section->inputs];
    return (const combination_t *)(const void *)(first + i * (COMBINATION_WORDS + section->inputs));
}

static const uint32_t *currents_of(const section_t *section) {
    return (const uint32_t *)(const void *)combination_of(section, section->signs);
}

static uint32_t size(const uint32_t *words, uint32_t left) {
    const section_t *section = (const section_t *)(const void *)words;
    const bool has_shape = left >= SECTION_WORDS && section->inputs >= 1u &&
                           section->inputs <= MOST_INPUTS && section->signs >= 1u &&
                           section->signs <= MOST_SIGNS && left >= words_in(section);
    return has_shape ? words_in(section) : 0;
}

static bool is_combination_good(const combination_t *one, uint32_t inputs) {
    return one->band >= 0 && one->band < STATE_SPACE_COEFFICIENT_LIMIT &&
           one->shift <= MOST_SHIFT && state_space_are_coefficients_good(one->coefficient, inputs);
}

static bool is_good(const uint32_t *words) {
    const section_t *section = (const section_t *)(const void *)words;
    bool is_right = section->idle_mA <= QUIESCE_HIGHEST_CURRENT_mA &&
                    view_inputs_are_good(section->input, section->inputs);
    for (uint32_t i = 0; i < section->signs; i++) {
        is_right = is_right && is_combination_good(combination_of(section, i), section->inputs);
    }
    for (uint32_t i = 0; i < 1u << section->signs; i++) {
        is_right = is_right && currents_of(section)[i] <= QUIESCE_HIGHEST_CURRENT_mA;
    }
    return is_right;
}

static uint64_t needs(const uint32_t *words, uint32_t i) {
    const section_t *section = (const section_t *)(const void *)words;
    (void)i;
    return view_inputs_need(section->input, section->inputs);
}

static const sections_kind_t sections = {size, is_good, needs};

static quiesce_table_verdict_t check(const uint32_t *words) {
    return sections_check(&sections, words);
}

static uint64_t needs_of_table(const uint32_t *words) {
    return sections_need(&sections, words);
}

static void decide(signs_t *self, uint32_t i, const combination_t *one, const int32_t *u,
                   uint32_t inputs) {
    const int64_t band = (int64_t)one->band << one->shift;
    int64_t sum = 0;
    for (uint32_t k = 0; k < inputs; k++) {
        sum += (int64_t)one->coefficient[k] * u[k];
    }
    if (sum > band || sum < -band) {
        self->known |= (uint8_t)(1u << i);
        self->on = (uint8_t)((self->on & ~(1u << i)) | (sum > 0 ? 1u << i : 0u));
    }
}

static int32_t current_mA(signs_t *self, const section_t *section, const view_t *view) {
    int32_t u[MOST_INPUTS];
    view_inputs_read(section->input, section->inputs, view, u);
    for (uint32_t i = 0; i < section->signs; i++) {
        decide(self, i, combination_of(section, i), u, section->inputs);
    }
    const bool is_known = self->known == (1u << section->signs) - 1u;
    return (int32_t)(is_known && !view->is_at_rest ? currents_of(section)[self->on]
                                                   : section->idle_mA);
}

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    signs_t *self = state;
    const section_t *section = sections_first(setup->table);
    law_demand_all(out, 0);
    for (uint32_t i = 0; i < sections_count(setup->table); i++) {
        out->value[i] = current_mA(&self[i], section, view);
        section = after(section);
    }
    return true;
}

static const quiesce_word_t reports[QUIESCE_REPORT_WORDS] = {
    {"signs_1", "bits"},
    {"signs_2", "bits"},
    {"signs_3", "bits"},
    {"signs_4", "bits"},
};

static void report(const void *state, const law_setup_t *setup, int32_t word[]) {
    const signs_t *self = state;
    (void)setup;
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        word[i] = self[i].on;
    }
}

static const table_kind_t patterns = {
    .name = "signs",
    .magic = SIGNS_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = check,
    .needs = needs_of_table,
};

extern const law_t law_signs;
const law_t law_signs = {
    .name = "signs",
    .kind = &patterns,
    .reports = reports,
    .step = step,
    .report = report,
};
