/// What the files of the engine for any system share; nothing for the outside.
#ifndef FUZZY_SYSTEM_FORMS_H
#define FUZZY_SYSTEM_FORMS_H

#include "fuzzy_system.h"

/// Of an output with values, so far.
typedef struct {
    int64_t weighted; ///< strengths x values
    uint64_t strength;
} fuzzy_activation_t;

/// One evaluation.
typedef struct {
    int32_t input[FUZZY_SYSTEM_MAX_INPUTS]; ///< within the universe
    uint32_t membership_q30[FUZZY_SYSTEM_ALL_TERMS];
    uint32_t term_q30[FUZZY_SYSTEM_ALL_TERMS]; ///< of the outputs: aggregated
    fuzzy_activation_t activation[FUZZY_MAX_OUTPUTS];
    uint32_t strength_q30[FUZZY_SYSTEM_LISTED]; ///< of the rules, where they are listed
    int32_t output[FUZZY_MAX_OUTPUTS];          ///< those found so far
} fuzzy_work_t;

static inline const void *fuzzy_system_at(const fuzzy_system_t *table, uint32_t offset_words) {
    return (const uint32_t *)(const void *)table + offset_words;
}

static inline const fuzzy_system_output_t *fuzzy_system_output(const fuzzy_system_t *table,
                                                               uint32_t index) {
    return (const fuzzy_system_output_t *)fuzzy_system_at(table, table->outputs_offset) + index;
}

/// Number of an output's term among those of all outputs.
static inline uint32_t fuzzy_term_number(const fuzzy_system_output_t *output, uint32_t term) {
    return (output->first + term) % FUZZY_SYSTEM_ALL_TERMS;
}

static inline const fuzzy_block_t *fuzzy_system_block(const fuzzy_system_t *table, uint32_t index) {
    return (const fuzzy_block_t *)fuzzy_system_at(table, table->blocks_offset) + index;
}

/// Half words of a rule.
static inline const uint16_t *fuzzy_rule_ops(const fuzzy_system_rule_t *rule) {
    return (const uint16_t *)(const void *)(rule + 1);
}

static inline const uint16_t *fuzzy_rule_conclusions(const fuzzy_system_rule_t *rule) {
    return fuzzy_rule_ops(rule) + (rule->ops + 1u) / 2u * 2u;
}

static inline const fuzzy_system_rule_t *fuzzy_next_rule(const fuzzy_system_rule_t *rule) {
    return (const fuzzy_system_rule_t *)(const void *)(fuzzy_rule_conclusions(rule) +
                                                       (rule->conclusions + 1u) / 2u * 2u);
}

static inline uint32_t fuzzy_concluded_output(uint32_t conclusion) {
    return conclusion >> 8 & 3u;
}

/// What a conclusion's hedge makes of the rule's strength; so_far: what the one before made of it.
static inline uint32_t fuzzy_hedged(uint32_t conclusion, uint32_t rule_q30, uint32_t so_far_q30) {
    return fuzzy_hedge((fuzzy_hedge_t)(conclusion >> 12),
                       (conclusion & FUZZY_FRESH) != 0 ? rule_q30 : so_far_q30);
}

static inline bool fuzzy_has_sets(const fuzzy_system_output_t *output) {
    return output->method >= FUZZY_CENTRE_OF_GRAVITY;
}

/// Bits that strengths have less, so that their products with values add up in 63 bits.
static inline uint32_t fuzzy_spare_bits(const fuzzy_system_t *table) {
    const uint32_t bits = 32u - (uint32_t)__builtin_clz(table->rules);
    return bits > 3u ? bits - 3u : 0;
}

/// x: from `least` on, where the curve begins.
uint32_t fuzzy_curve_at(const fuzzy_system_t *table, fuzzy_curve_t curve, int32_t least, int32_t x);

/// Value of a term that is a formula, counts x 2^fraction of its output.
int32_t fuzzy_formula_at(const fuzzy_system_t *table, const fuzzy_value_t *value,
                         const fuzzy_work_t *work);

/// The number that an output with sets comes to. False where they are 0 everywhere.
bool fuzzy_defuzzify(const fuzzy_system_t *table, uint32_t index, const fuzzy_work_t *work,
                     int32_t *value);

#endif
