/// Fuzzy inference in integers, over a table. One to four inputs and outputs, up to seven sets
/// each.
///
/// Meaning (tools/src/quiesce/rules/model.py has it in real numbers):
///   strength of a rule = weight * min (or max) over its conditions of the set's membership, or of
///   1 - membership where negated; a rule fires where its strength is above 0
///   FUZZY_SUM       sum strength * singleton / sum strength, over rules
///   FUZZY_MAX       the same over terms, each with the greatest strength of its rules
///   FUZZY_CENTROID  of max over terms of min(greatest strength of its rules, set), exactly
/// Formats: inputs int32 in the table's units, any value (the ends of the universe hold beyond it);
/// memberships and strengths 2^-bits, to nearest; weights Q19, products to nearest; sums of
/// singletons exact in 64 bits, their quotient to nearest; a centroid's areas Q26 of the universe,
/// its quotient from sums of 22 significant bits. Outputs int32 in the table's units. Nothing
/// overflows with a table that fuzzy_table_check() accepts. Straight-line C from `quiesce rules
/// compile` computes the same numbers, bit for bit.
#ifndef FUZZY_H
#define FUZZY_H

#include "fuzzy_table.h"

/// An engine: this one with its table, or straight-line C. input: as many as the base has.
/// Returns a bit for each output that no rule reached: it has its default.
typedef uint32_t (*fuzzy_function_t)(const int32_t *input, int32_t *output);

/// Evaluates a table that fuzzy_table_check() accepts. Returns as fuzzy_function_t. Bounded by the
/// table: about 120 instructions for a grid of singletons, else 10 to 20 a rule.
uint32_t fuzzy_evaluate(const fuzzy_table_t *table, const int32_t *input, int32_t *output);

/// The rules that fire: bit i of fired is rule i, for the first 64. Returns how many fire in all.
uint32_t fuzzy_fired(const fuzzy_table_t *table, const int32_t *input, uint64_t *fired);

#endif
