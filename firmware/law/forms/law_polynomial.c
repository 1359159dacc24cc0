// A current that is a polynomial of measurements, for each damper by itself (Cha and others 2013).
//
// Its table, after the head of all tables: sections, one a damper from the first on. A section:
// inputs m, terms t; m inputs (view_signal.h), each with a fourth word, 1 where its magnitude is
// taken; t terms {coefficient in mA, Q8, below 2^30; powers, a byte an input, 0 .. 3}. Inputs are
// Q30; each product is rounded down, in the order of the inputs; the sum is below 2^34 before the
// last shift and is limited to 0 .. 20000 mA. `quiesce law make` writes them.
#include "fixq.h"
#include "law.h"
#include "sections.h"
#include "view_signal.h"

#define POLYNOMIAL_MAGIC UINT32_C(0x314C5051)

enum { MOST_INPUTS = 4, MOST_TERMS = 16, MOST_POWER = 3 };

typedef struct {
    view_input_t read;
    uint32_t is_magnitude;
} input_t;

typedef struct {
    int32_t coefficient_q8;
    uint8_t power[MOST_INPUTS];
} term_t;

typedef struct {
    uint32_t inputs;
    uint32_t terms;
    input_t input[];
} section_t;

enum { SECTION_WORDS = 2, INPUT_WORDS = 4, TERM_WORDS = 2 };

_Static_assert(sizeof(input_t) == 4u * INPUT_WORDS, "words on the wire");
_Static_assert(sizeof(term_t) == 4u * TERM_WORDS, "words on the wire");

static uint32_t words_in(const section_t *section) {
    return SECTION_WORDS + INPUT_WORDS * section->inputs + TERM_WORDS * section->terms;
}

static const term_t *terms_of(const section_t *section) {
    return (const term_t *)(const void *)&section->input[section->inputs];
}

static const section_t *after(const section_t *section) {
    return (const section_t *)(const void *)&terms_of(section)[section->terms];
}

static uint32_t size(const uint32_t *words, uint32_t left) {
    const section_t *section = (const section_t *)(const void *)words;
    const bool has_shape = left >= SECTION_WORDS && section->inputs >= 1u &&
                           section->inputs <= MOST_INPUTS && section->terms >= 1u &&
                           section->terms <= MOST_TERMS && left >= words_in(section);
    return has_shape ? words_in(section) : 0;
}

static bool is_term_good(const term_t *term, uint32_t inputs) {
    bool is_right = abs_i32(term->coefficient_q8) <= VIEW_LIMIT;
    for (uint32_t i = 0; i < MOST_INPUTS; i++) {
        is_right = is_right && term->power[i] <= (i < inputs ? MOST_POWER : 0);
    }
    return is_right;
}

static bool is_good(const uint32_t *words) {
    const section_t *section = (const section_t *)(const void *)words;
    bool is_right = true;
    for (uint32_t i = 0; i < section->inputs; i++) {
        is_right = is_right && view_inputs_are_good(&section->input[i].read, 1) &&
                   section->input[i].is_magnitude <= 1u;
    }
    for (uint32_t i = 0; i < section->terms; i++) {
        is_right = is_right && is_term_good(&terms_of(section)[i], section->inputs);
    }
    return is_right;
}

static uint64_t needs(const uint32_t *words, uint32_t i) {
    const section_t *section = (const section_t *)(const void *)words;
    uint64_t bits = 0;
    (void)i;
    for (uint32_t k = 0; k < section->inputs; k++) {
        bits |= view_inputs_need(&section->input[k].read, 1);
    }
    return bits;
}

static const sections_kind_t sections = {size, is_good, needs};

static quiesce_table_verdict_t check(const uint32_t *words) {
    return sections_check(&sections, words);
}

static uint64_t needs_of_table(const uint32_t *words) {
    return sections_need(&sections, words);
}

static int32_t input_q30(const input_t *input, const view_t *view) {
    int32_t value = 0;
    view_inputs_read(&input->read, 1, view, &value);
    return input->is_magnitude != 0 ? abs_i32(value) : value;
}

// Q38: mA in Q8 times products in Q30, below 2^60.
static int64_t term_q38(const term_t *term, const int32_t *x_q30, uint32_t inputs) {
    int64_t product_q30 = INT64_C(1) << 30;
    for (uint32_t i = 0; i < inputs; i++) {
        for (uint32_t k = 0; k < term->power[i]; k++) {
            product_q30 = (product_q30 * x_q30[i]) >> 30;
        }
    }
    return product_q30 * term->coefficient_q8;
}

static int32_t current_mA(const section_t *section, const view_t *view) {
    int32_t x_q30[MOST_INPUTS];
    int64_t sum_q8 = 0;
    for (uint32_t i = 0; i < section->inputs; i++) {
        x_q30[i] = input_q30(&section->input[i], view);
    }
    for (uint32_t i = 0; i < section->terms; i++) {
        sum_q8 += term_q38(&terms_of(section)[i], x_q30, section->inputs) >> 30;
    }
    return (int32_t)clamp_i64(sum_q8 >> 8, 0, QUIESCE_HIGHEST_CURRENT_mA);
}

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    const section_t *section = sections_first(setup->table);
    (void)state;
    law_demand_all(out, 0);
    for (uint32_t i = 0; i < sections_count(setup->table); i++) {
        out->value[i] = current_mA(section, view);
        section = after(section);
    }
    return true;
}

static const table_kind_t terms = {
    .name = "polynomial",
    .magic = POLYNOMIAL_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = check,
    .needs = needs_of_table,
};

extern const law_t law_polynomial;
const law_t law_polynomial = {.name = "polynomial", .kind = &terms, .step = step};
