// A current by fuzzy rules over any signals, for each damper by itself: Mamdani's with sets,
// Takagi's and Sugeno's with constants or, of first order, with straight lines.
//
// Its table: sections (sections.h). A section: inputs m, slopes t, words of rules; m inputs
// (view_signal.h), each with a fourth word, 1 where its magnitude is taken; t slopes {input,
// shift}; a whole table of rules (fuzzy_table.h), or none: those of the section before. The rules
// have the section's m inputs, as many integers as they are here, and 1 + t outputs: a current in
// mA, Q8, and what each slope's input is multiplied with. The current is output 0 + the sum of
// (output x input) >> shift, floor, three products below 2^61 at most; limited to 0 .. 20000 mA,
// floor. `quiesce law make` and `quiesce law rules` write them.
#include <stddef.h>

#include "fixq.h"
#include "fuzzy.h"
#include "law.h"
#include "sections.h"
#include "view_signal.h"

#define FUZZY_SIGNALS_MAGIC UINT32_C(0x31534651)

enum { MOST_SLOPES = FUZZY_MAX_OUTPUTS - 1, MOST_SHIFT = 62 };

typedef struct {
    view_input_t read;
    uint32_t is_magnitude;
} input_t;

typedef struct {
    uint32_t input;
    uint32_t shift;
} slope_t;

typedef struct {
    uint32_t inputs;
    uint32_t slopes;
    uint32_t rule_words;
    input_t input[];
} section_t;

enum { SECTION_WORDS = 3, INPUT_WORDS = 4, SLOPE_WORDS = 2 };

_Static_assert(sizeof(input_t) == 4u * INPUT_WORDS, "words on the wire");
_Static_assert(sizeof(slope_t) == 4u * SLOPE_WORDS, "words on the wire");

// What a damper's rules saw last, for the report.
typedef struct {
    int32_t x[FUZZY_MAX_INPUTS];
} seen_t;

_Static_assert(sizeof(seen_t) * QUIESCE_DAMPERS <= LAW_STATE_BYTES, "the arena is too small");

static const section_t *as_section(const uint32_t *words) {
    return (const section_t *)(const void *)words;
}

static uint32_t words_in(const section_t *section) {
    return SECTION_WORDS + INPUT_WORDS * section->inputs + SLOPE_WORDS * section->slopes +
           section->rule_words;
}

static const section_t *after(const section_t *section) {
    return as_section((const uint32_t *)(const void *)section + words_in(section));
}

static const slope_t *slopes_of(const section_t *section) {
    return (const slope_t *)(const void *)&section->input[section->inputs];
}

// before: rules of the section before; NULL: there is none.
static const fuzzy_table_t *rules_of(const section_t *section, const fuzzy_table_t *before) {
    return section->rule_words == 0
               ? before
               : (const fuzzy_table_t *)(const void *)&slopes_of(section)[section->slopes];
}

// ---- check --------------------------------------------------------------------------------------

static uint32_t size(const uint32_t *words, uint32_t left) {
    const section_t *section = as_section(words);
    const bool has_shape = left >= SECTION_WORDS && section->inputs >= 1u &&
                           section->inputs <= FUZZY_MAX_INPUTS && section->slopes <= MOST_SLOPES &&
                           section->rule_words <= left && words_in(section) <= left;
    return has_shape ? words_in(section) : 0;
}

// Their own CRC is not summed: that of the whole table, found right, covers them.
static bool are_rules_good(const section_t *section) {
    const fuzzy_table_t *rules = rules_of(section, NULL);
    return rules == NULL ||
           (section->rule_words >= FUZZY_HEADER_WORDS && rules->magic == FUZZY_MAGIC &&
            rules->size_words == section->rule_words &&
            fuzzy_table_check_summed(rules) == FUZZY_TABLE_OK);
}

static bool is_good(const uint32_t *words) {
    const section_t *section = as_section(words);
    bool is_right = are_rules_good(section);
    for (uint32_t i = 0; i < section->inputs; i++) {
        is_right = is_right && view_inputs_are_good(&section->input[i].read, 1) &&
                   section->input[i].is_magnitude <= 1u;
    }
    for (uint32_t i = 0; i < section->slopes; i++) {
        const slope_t *slope = &slopes_of(section)[i];
        is_right = is_right && slope->input < section->inputs && slope->shift <= MOST_SHIFT;
    }
    return is_right;
}

static uint64_t needs(const uint32_t *words, uint32_t i) {
    const section_t *section = as_section(words);
    uint64_t bits = 0;
    (void)i;
    for (uint32_t k = 0; k < section->inputs; k++) {
        bits |= view_inputs_need(&section->input[k].read, 1);
    }
    return bits;
}

static const sections_kind_t sections = {size, is_good, needs};

// Whether each section of a checked table has rules, and they are of its shape.
static bool do_rules_fit(const uint32_t *words) {
    const section_t *section = sections_first(words);
    const fuzzy_table_t *rules = NULL;
    for (uint32_t i = 0; i < sections_count(words); i++) {
        rules = rules_of(section, rules);
        if (rules == NULL || rules->inputs != section->inputs ||
            rules->outputs != 1u + section->slopes) {
            return false;
        }
        section = after(section);
    }
    return true;
}

static quiesce_table_verdict_t check(const uint32_t *words) {
    const quiesce_table_verdict_t verdict = sections_check(&sections, words);
    if (verdict != QUIESCE_TABLE_OK) {
        return verdict;
    }
    return do_rules_fit(words) ? QUIESCE_TABLE_OK : QUIESCE_TABLE_SHAPE;
}

static uint64_t needs_of_table(const uint32_t *words) {
    return sections_need(&sections, words);
}

// ---- step ---------------------------------------------------------------------------------------

static int32_t value_of(const input_t *input, const view_t *view) {
    int32_t value = 0;
    view_inputs_read(&input->read, 1, view, &value);
    return input->is_magnitude != 0 ? abs_i32(value) : value;
}

static int32_t current_mA(const section_t *section, const fuzzy_table_t *rules, const int32_t *x) {
    int32_t out[FUZZY_MAX_OUTPUTS];
    (void)fuzzy_evaluate(rules, x, out);
    int64_t sum_q8 = out[0];
    for (uint32_t i = 0; i < section->slopes; i++) {
        const slope_t *slope = &slopes_of(section)[i];
        sum_q8 += ((int64_t)out[1u + i] * x[slope->input]) >> slope->shift;
    }
    return (int32_t)clamp_i64(sum_q8 >> 8, 0, QUIESCE_HIGHEST_CURRENT_mA);
}

static bool step(void *state, const law_setup_t *setup, const view_t *view, law_demand_t *out) {
    seen_t *seen = state;
    const section_t *section = sections_first(setup->table);
    const fuzzy_table_t *rules = NULL;
    law_demand_all(out, 0);
    for (uint32_t i = 0; i < sections_count(setup->table); i++) {
        rules = rules_of(section, rules);
        for (uint32_t k = 0; k < section->inputs; k++) {
            seen[i].x[k] = value_of(&section->input[k], view);
        }
        out->value[i] = current_mA(section, rules, seen[i].x);
        section = after(section);
    }
    return true;
}

static const quiesce_word_t reports[QUIESCE_REPORT_WORDS] = {
    {"rules_fired_1", "bits"},
    {"rules_fired_2", "bits"},
    {"rules_fired_3", "bits"},
    {"rules_fired_4", "bits"},
};

// A bit for each rule that fired, the first 32; before the first tick, of inputs of 0.
static void report(const void *state, const law_setup_t *setup, int32_t word[]) {
    const seen_t *seen = state;
    const fuzzy_table_t *rules = NULL;
    if (setup->table == NULL) {
        return;
    }
    const section_t *section = sections_first(setup->table);
    for (uint32_t i = 0; i < sections_count(setup->table); i++) {
        uint64_t fired = 0;
        rules = rules_of(section, rules);
        (void)fuzzy_fired(rules, seen[i].x, &fired);
        word[i] = (int32_t)(uint32_t)fired;
        section = after(section);
    }
}

static const table_kind_t rules_over_signals = {
    .name = "rules_on_signals",
    .magic = FUZZY_SIGNALS_MAGIC,
    .least_words = SECTIONS_FIRST,
    .check = check,
    .needs = needs_of_table,
};

extern const law_t law_fuzzy_signals;
const law_t law_fuzzy_signals = {
    .name = "fuzzy_signals",
    .kind = &rules_over_signals,
    .reports = reports,
    .step = step,
    .report = report,
};
