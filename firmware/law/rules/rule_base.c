#include "rule_base.h"

#include <stddef.h>

#include "fuzzy.h"
#include "plant_rules.h"

#ifndef QUIESCE_WITH_RULE_TABLES
#define QUIESCE_WITH_RULE_TABLES 1
#endif

// Uses of a table: 1, frequency in uHz and RMS acceleration in um/s2 to a current in mA.
#define RULE_UNITS 1u
// Whatever a loaded table says, a request stays a current that arithmetic can hold.
#define RULES_MAX_mA 1000000

#if QUIESCE_WITH_RULE_TABLES

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

// The shipped rules run as straight-line C, the same numbers in half the time.
static int32_t evaluated_mA(const uint32_t *table, const int32_t input[RULE_BASE_INPUTS]) {
    int32_t mA[FUZZY_MAX_OUTPUTS] = {0}; // one, unless the table was damaged since its check
    (void)(table == plant_rules_table ? plant_rules(input, mA)
                                      : fuzzy_evaluate(as_table(table), input, mA));
    return mA[0];
}

static uint64_t fired_rules(const uint32_t *table, const int32_t input[RULE_BASE_INPUTS]) {
    uint64_t fired = 0;
    (void)fuzzy_fired(as_table(table), input, &fired);
    return fired;
}

#else

// The words that ship and no others: what runs is their straight-line C, which has no list of the
// rules that fire.
static quiesce_table_verdict_t check(const uint32_t *words) {
    const uint32_t count = words[TABLE_WORDS];
    if (count != plant_rules_table[TABLE_WORDS]) {
        return QUIESCE_TABLE_MAGIC;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (words[i] != plant_rules_table[i]) {
            return QUIESCE_TABLE_MAGIC;
        }
    }
    return QUIESCE_TABLE_OK;
}

static int32_t evaluated_mA(const uint32_t *table, const int32_t input[RULE_BASE_INPUTS]) {
    (void)table;
    int32_t mA = 0;
    (void)plant_rules(input, &mA);
    return mA;
}

static uint64_t fired_rules(const uint32_t *table, const int32_t input[RULE_BASE_INPUTS]) {
    (void)table;
    (void)input;
    return 0;
}

#endif

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

int32_t rule_base_step(rule_base_t *self, const uint32_t *table, const view_tone_t *tone) {
    const bool is_same =
        self->is_known && self->input[0] == tone->freq_uHz && self->input[1] == tone->rms_um_s2;
    if (!is_same) {
        *self = (rule_base_t){.is_known = true, .input = {tone->freq_uHz, tone->rms_um_s2}};
        self->current_mA = clamp_i32(evaluated_mA(table, self->input), 0, RULES_MAX_mA);
    }
    return self->current_mA;
}

void rule_base_retable(void *state, const law_setup_t *setup) {
    (void)setup;
    ((rule_base_t *)state)->is_known = false;
}

void rule_base_report(const void *state, const law_setup_t *setup, int32_t *word) {
    const rule_base_t *self = state;
    word[0] = self->current_mA;
    word[1] = self->is_known ? (int32_t)(uint32_t)fired_rules(setup->table, self->input) : 0;
}
