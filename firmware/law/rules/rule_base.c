#include "rule_base.h"

#include <stddef.h>

#include "fuzzy.h"
#include "plant_rules.h"

// Uses of a table: 1, frequency in uHz and RMS acceleration in um/s2 to a current in mA.
#define RULE_UNITS 1u
// Whatever a loaded table says, a request stays a current that arithmetic can hold.
#define RULES_MAX_mA 1000000

static const fuzzy_table_t *as_table(const uint32_t *words) {
    return (const fuzzy_table_t *)(const void *)words;
}

static quiesce_table_verdict_t check(const uint32_t *words) {
    const fuzzy_table_t *table = as_table(words);
    const fuzzy_verdict_t verdict = fuzzy_table_check_summed(table);
    if (verdict != FUZZY_TABLE_OK) {
        return (quiesce_table_verdict_t)verdict;
    }
    const bool fits =
        table->inputs == RULE_BASE_INPUTS && table->outputs == 1u && table->units == RULE_UNITS;
    return fits ? QUIESCE_TABLE_OK : QUIESCE_TABLE_FIT;
}

const table_kind_t rule_base_kind = {
    .name = "rules",
    .magic = FUZZY_MAGIC,
    .least_words = FUZZY_HEADER_WORDS,
    .shipped = plant_rules_table,
    .check = check,
};

const quiesce_word_t rule_base_reports[QUIESCE_REPORT_WORDS] = {
    {"current_fuzzy_mA", "mA"},
    {"rules_fired", "bits"},
};

// The shipped rules run as straight-line C, the same numbers in half the time.
static int32_t current_mA(const uint32_t *table, const int32_t input[RULE_BASE_INPUTS]) {
    int32_t mA = 0;
    (void)(table == plant_rules_table ? plant_rules(input, &mA)
                                      : fuzzy_evaluate(as_table(table), input, &mA));
    return clamp_i32(mA, 0, RULES_MAX_mA);
}

int32_t rule_base_step(rule_base_t *self, const uint32_t *table, const view_tone_t *tone) {
    const bool is_same =
        self->is_known && self->input[0] == tone->freq_uHz && self->input[1] == tone->rms_um_s2;
    if (!is_same) {
        *self = (rule_base_t){.is_known = true, .input = {tone->freq_uHz, tone->rms_um_s2}};
        self->current_mA = current_mA(table, self->input);
    }
    return self->current_mA;
}

void rule_base_retable(void *state, const law_setup_t *setup) {
    (void)setup;
    ((rule_base_t *)state)->is_known = false;
}

void rule_base_report(const void *state, const law_setup_t *setup, int32_t *word) {
    const rule_base_t *self = state;
    uint64_t fired = 0;
    if (self->is_known) {
        (void)fuzzy_fired(as_table(setup->table), self->input, &fired);
    }
    word[0] = self->current_mA;
    word[1] = (int32_t)(uint32_t)fired;
}
