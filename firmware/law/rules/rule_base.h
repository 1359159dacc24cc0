/// A rule base from frequency (uHz) and RMS acceleration (um/s2) to a current (mA): what the fuzzy
/// laws share.
///
/// It is evaluated where an input has changed, every few ticks. Bounded by its table: some 120
/// instructions for a grid of singletons.
#ifndef RULE_BASE_H
#define RULE_BASE_H

#include "law.h"

#define RULE_BASE_INPUTS 2u

/// Tables that fuzzy_table_check accepts and that have these inputs and one output.
extern const table_kind_t rule_base_kind;

/// Words of a report: QUIESCE_REPORT_WORDS of them.
extern const quiesce_word_t rule_base_reports[];

/// What was said last. Zeros: nothing yet.
typedef struct {
    bool is_known;
    int32_t input[RULE_BASE_INPUTS];
    int32_t current_mA;
} rule_base_t;

/// Its current in mA, 0 .. 10^6.
int32_t rule_base_step(rule_base_t *self, const uint32_t *table, const view_tone_t *tone);

/// That current, or law_unlock_mA while no frequency is known.
static inline int32_t rule_base_or_unlock_mA(const law_setup_t *setup, const view_t *view,
                                             int32_t current_mA) {
    return (view->valid & VIEW_TONE) != 0 ? current_mA : law_unlock_mA(&setup->params, view);
}

/// As in law_t, of a law whose state begins with a rule_base_t. What the rules said last is
/// forgotten: the same words may hold another table by now.
void rule_base_retable(void *state, const law_setup_t *setup);

/// Likewise: the last current, and a bit for each rule that fired, in the file's order, the first
/// 32. The list of rules is made here: some 800 instructions for 16 rules.
void rule_base_report(const void *state, const law_setup_t *setup, int32_t *word);

#endif
