#include "force_bank.h"

#include <stddef.h>

#include "fixq.h"
#include "sections.h"

#define ONE_Q30 (INT32_C(1) << 30)

enum { SECTION_WORDS = 6, ELEMENT_WORDS = 3, MODEL_WORDS = 3, HALF_Q30 = 1 << 29 };
enum { LEAD_SHIFT = 20 };

typedef struct {
    uint32_t leads;
    int32_t leak_q30;
    int32_t limit_um_s;
} element_t;

typedef struct {
    uint32_t elements;
    uint32_t currents;
    int32_t rate_Hz;
    uint32_t shift;
    int32_t lead_q20; ///< um/s for a nm
    int32_t lead_um_s;
    element_t element[]; ///< then the models
} section_t;

typedef struct {
    int32_t current_mA;
    int32_t offset_mN;
    int32_t spring;
    int32_t weight[];
} model_t;

_Static_assert(offsetof(section_t, element) == 4u * SECTION_WORDS, "words on the wire");
_Static_assert(sizeof(element_t) == 4u * ELEMENT_WORDS, "words on the wire");
_Static_assert(offsetof(model_t, weight) == 4u * MODEL_WORDS, "words on the wire");

static const section_t *as_section(const uint32_t *words) {
    return (const section_t *)(const void *)words;
}

static const model_t *model_of(const section_t *bank, uint32_t k) {
    const int32_t *first = (const int32_t *)(const void *)&bank->element[bank->elements];
    return (const model_t *)(const void *)(first + k * (MODEL_WORDS + bank->elements));
}

static uint32_t words_in(const section_t *bank) {
    return SECTION_WORDS + ELEMENT_WORDS * bank->elements +
           bank->currents * (MODEL_WORDS + bank->elements);
}

static uint32_t size(const uint32_t *words, uint32_t left) {
    const section_t *bank = as_section(words);
    const bool has_shape = left >= SECTION_WORDS && bank->elements >= 1u &&
                           bank->elements <= FORCE_BANK_MAX_ELEMENTS &&
                           bank->currents >= FORCE_BANK_MIN_CURRENTS &&
                           bank->currents <= FORCE_BANK_MAX_CURRENTS && left >= words_in(bank);
    return has_shape ? words_in(bank) : 0;
}

static bool is_element_good(const element_t *element) {
    return element->leads <= 1u && element->leak_q30 >= 0 && element->leak_q30 <= ONE_Q30 &&
           element->limit_um_s > 0 && element->limit_um_s <= VIEW_LIMIT;
}

// Each product is below 2^61: no sum passes 2^63 before it is seen to be beyond 2^62.
static bool is_sum_bounded(const section_t *bank, const model_t *model) {
    const int64_t most = INT64_C(1) << 62;
    int64_t sum = (int64_t)abs_i32(model->spring) * VIEW_LIMIT;
    for (uint32_t j = 0; j < bank->elements; j++) {
        if (model->weight[j] < 0 || sum > most) {
            return false;
        }
        sum += (int64_t)model->weight[j] * bank->element[j].limit_um_s;
    }
    return sum <= most;
}

static bool are_models_good(const section_t *bank) {
    int32_t last_mA = -1;
    for (uint32_t k = 0; k < bank->currents; k++) {
        const model_t *model = model_of(bank, k);
        const bool is_current_good = k == 0 ? model->current_mA == 0 : model->current_mA > last_mA;
        if (!is_current_good || model->offset_mN < -VIEW_LIMIT || model->offset_mN > VIEW_LIMIT ||
            !is_sum_bounded(bank, model)) {
            return false;
        }
        last_mA = model->current_mA;
    }
    return last_mA <= QUIESCE_HIGHEST_CURRENT_mA;
}

static bool is_good(const uint32_t *words) {
    const section_t *bank = as_section(words);
    for (uint32_t j = 0; j < bank->elements; j++) {
        if (!is_element_good(&bank->element[j])) {
            return false;
        }
    }
    return bank->rate_Hz > 0 && bank->shift <= FORCE_BANK_MAX_SHIFT && bank->lead_um_s >= 0 &&
           bank->lead_um_s <= VIEW_LIMIT && are_models_good(bank);
}

static uint64_t needs(const uint32_t *words, uint32_t i) {
    const section_t *bank = as_section(words);
    bool is_stroke_used = false;
    for (uint32_t j = 0; j < bank->elements; j++) {
        is_stroke_used = is_stroke_used || bank->element[j].leads != 0;
    }
    for (uint32_t k = 0; k < bank->currents; k++) {
        is_stroke_used = is_stroke_used || model_of(bank, k)->spring != 0;
    }
    return (VIEW_STROKE_VELOCITY | (is_stroke_used ? VIEW_STROKE : 0)) << i;
}

static const sections_kind_t kind = {
    .size = size,
    .is_good = is_good,
    .needs = needs,
};

quiesce_table_verdict_t force_bank_check(const uint32_t *words) {
    return sections_check(&kind, words);
}

uint64_t force_bank_needs(const uint32_t *words) {
    return sections_shared_need(&kind, words);
}

const uint32_t *force_bank_section(const uint32_t *words, uint32_t damper) {
    return sections_shared(&kind, words, damper);
}

uint32_t force_bank_currents(const uint32_t *section) {
    return as_section(section)->currents;
}

uint32_t force_bank_rate_Hz(const uint32_t *words) {
    const int32_t rate_Hz = as_section(sections_first(words))->rate_Hz;
    for (uint32_t i = 1; i < sections_count(words); i++) {
        if (as_section(force_bank_section(words, i))->rate_Hz != rate_Hz) {
            return 0;
        }
    }
    return (uint32_t)rate_Hz;
}

// Limited to what a velocity is limited to.
static int32_t led_um_s(const section_t *bank, const view_damper_t *damper) {
    const int64_t lead_um_s = ((int64_t)bank->lead_q20 * damper->stroke_nm) >> LEAD_SHIFT;
    return (int32_t)clamp_i64(damper->velocity_um_s +
                                  clamp_i64(lead_um_s, -bank->lead_um_s, bank->lead_um_s),
                              -VIEW_LIMIT, VIEW_LIMIT);
}

// A state and what it follows are below 2^30: their sum is below 2^31.
void force_bank_move(force_bank_t *self, const uint32_t *section, const view_damper_t *damper) {
    const section_t *bank = as_section(section);
    const int32_t velocity_um_s = damper->velocity_um_s;
    const int32_t led = bank->lead_q20 != 0 ? led_um_s(bank, damper) : velocity_um_s;
    for (uint32_t j = 0; j < bank->elements; j++) {
        const element_t *element = &bank->element[j];
        const int32_t z = self->z[j];
        const int32_t lost = (int32_t)(((int64_t)z * element->leak_q30 + HALF_Q30) >> 30);
        self->z[j] = clamp_i32(z - lost + (element->leads != 0 ? led : velocity_um_s),
                               -element->limit_um_s, element->limit_um_s);
    }
}

static int32_t force_mN(const force_bank_t *self, const section_t *bank, const model_t *model,
                        int32_t stroke_nm) {
    int64_t sum = (int64_t)model->spring * stroke_nm;
    for (uint32_t j = 0; j < bank->elements; j++) {
        sum += (int64_t)model->weight[j] * self->z[j];
    }
    const int64_t half = bank->shift == 0 ? 0 : INT64_C(1) << (bank->shift - 1u);
    return (int32_t)clamp_i64(((sum + half) >> bank->shift) + model->offset_mN, -VIEW_LIMIT,
                              VIEW_LIMIT);
}

int32_t force_bank_force_mN(const force_bank_t *self, const uint32_t *section, uint32_t k,
                            const view_damper_t *damper) {
    const section_t *bank = as_section(section);
    return force_mN(self, bank, model_of(bank, k), damper->stroke_nm);
}

// Forces in the direction of the demand: low_mN is below it, high_mN is not.
static int32_t between_mA(const model_t *low, const model_t *high, int64_t low_mN, int64_t high_mN,
                          int64_t wanted_mN) {
    const uint64_t gap_mN = (uint64_t)(high_mN - low_mN);
    const uint64_t step_mA = (uint64_t)(high->current_mA - low->current_mA);
    const uint64_t product = step_mA * (uint64_t)(wanted_mN - low_mN);
    return low->current_mA + (int32_t)((product + gap_mN / 2u) / gap_mN);
}

int32_t force_bank_current_mA(const force_bank_t *self, const uint32_t *section,
                              const view_damper_t *damper, int32_t demand_mN) {
    const section_t *bank = as_section(section);
    const int64_t side = sign_i64(demand_mN);
    const int64_t wanted_mN = side * demand_mN;
    const model_t *model = model_of(bank, 0);
    int64_t below_mN = side * force_mN(self, bank, model, damper->stroke_nm);
    if (side == 0 || below_mN >= wanted_mN) {
        return 0;
    }
    int64_t most_mN = below_mN;
    int32_t most_mA = 0;
    for (uint32_t k = 1; k < bank->currents; k++) {
        const model_t *next = model_of(bank, k);
        const int64_t next_mN = side * force_mN(self, bank, next, damper->stroke_nm);
        if (next_mN >= wanted_mN) {
            return between_mA(model, next, below_mN, next_mN, wanted_mN);
        }
        if (next_mN > most_mN) {
            most_mN = next_mN;
            most_mA = next->current_mA;
        }
        model = next;
        below_mN = next_mN;
    }
    return most_mN > 0 ? most_mA : 0;
}
