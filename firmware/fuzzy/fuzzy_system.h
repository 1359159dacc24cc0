/// Fuzzy systems of any kind in integers, over a table: up to eight inputs with terms of any shape,
/// all usual norms, hedges, rule blocks one after the other, outputs that conditions may name, and
/// all usual ways to a number. What fuzzy.h can do it does faster; this is for the rest
/// (`quiesce rules compile` chooses).
///
/// Meaning (tools/src/quiesce/rules/system/reference.py has it in real numbers):
///   strength of a rule = weight * its expression, whose conditions are memberships of an input, or
///   what an output has been activated with by the rules before, as hedged
///   FUZZY_BY_RULE   sum strength * value / sum strength, over rules
///   FUZZY_BY_TERM   the same over terms, each with its rules' strengths aggregated
///   FUZZY_WEIGHTED  sum strength * value, over rules
///   the rest        of the aggregation over rules, or terms, of implication(strength, set), taken
///                   at so many places, evenly over the output's universe
/// A membership or a value is a polynomial of first or third degree between places, or a formula of
/// such, of inputs and of outputs before its own.
///
/// Formats: inputs int32 in the table's units (the ends of the universe hold beyond it);
/// memberships Q30; values int32, counts times 2^fraction; strengths in a weighted sum less
/// log2(rules) - 3 bits. Outputs int32 in the table's units, to nearest, saturated. Nothing
/// overflows with a table that fuzzy_system_check() accepts.
///
/// Words: header (fuzzy_system_t), then at the offsets that it gives inputs, outputs, blocks,
/// rules; fuzzy_system_input_t and so on say what they hold.
#ifndef FUZZY_SYSTEM_H
#define FUZZY_SYSTEM_H

#include "fuzzy_norms.h"
#include "fuzzy_table.h"

#define FUZZY_SYSTEM_MAGIC UINT32_C(0x31535A46)
#define FUZZY_SYSTEM_MAX_INPUTS 8u
#define FUZZY_SYSTEM_MAX_TERMS 32u ///< of an input, and of an output with sets or by term
#define FUZZY_SYSTEM_MAX_VALUES 64u
#define FUZZY_SYSTEM_ALL_TERMS 128u ///< of all inputs together, and of all outputs
#define FUZZY_SYSTEM_MAX_STACK 8u
#define FUZZY_SYSTEM_LISTED 64u ///< rules of a system where some output takes them one by one
#define FUZZY_SYSTEM_MAX_PLACES 1024u
#define FUZZY_SYSTEM_MAX_SLOPE (INT32_C(1) << 29)
#define FUZZY_SYSTEM_MAX_VALUE (INT32_C(1) << 30)
#define FUZZY_FORMULA_OPS 64u
#define FUZZY_FORMULA_LIMIT (INT32_C(1) << 29) ///< of every value on a formula's stack
#define FUZZY_FRESH (1u << 11)
#define FUZZY_ONLY_HEDGE (1u << 10) ///< for the next one; no conclusion
#define FUZZY_LINE_WORDS 4u
#define FUZZY_CUBIC_WORDS 6u

typedef enum {
    FUZZY_BY_RULE,
    FUZZY_BY_TERM,
    FUZZY_WEIGHTED,
    FUZZY_CENTRE_OF_GRAVITY,
    FUZZY_BISECTOR,
    FUZZY_SMALLEST_OF_MAXIMUM,
    FUZZY_LARGEST_OF_MAXIMUM,
    FUZZY_MEAN_OF_MAXIMUM,
    FUZZY_SYSTEM_METHODS,
} fuzzy_system_method_t;

typedef enum {
    FUZZY_VALUE_CONSTANT,
    FUZZY_VALUE_LINEAR,        ///< value + sum of slopes x inputs
    FUZZY_VALUE_OF_STRENGTH,   ///< Tsukamoto: value + span x curve(strength)
    FUZZY_VALUE_OF_INPUT,      ///< value + span x curve(input)
    FUZZY_PRODUCT_OF_INPUT,    ///< the same, and already multiplied with the strength; not BY_TERM
    FUZZY_PRODUCT_OF_STRENGTH, ///< of values that have no end where the strength ends
    FUZZY_VALUE_FORMULA,       ///< value + span x formula 2^-shift, limited to +-2^30
    FUZZY_VALUES,
} fuzzy_value_kind_t;

/// What an op of a formula does on its stack of int32. Each result is limited to
/// +-FUZZY_FORMULA_LIMIT, right shifts round down.
typedef enum {
    FUZZY_FORMULA_CONSTANT, ///< pushes value
    FUZZY_FORMULA_INPUT,    ///< pushes value + span x (input - its least) 2^-left
    FUZZY_FORMULA_OUTPUT,   ///< the same of an output before it, counted from 0
    FUZZY_FORMULA_ADD,      ///< first 2^-left + second 2^-right; so are the next, but for
    FUZZY_FORMULA_SUBTRACT,
    FUZZY_FORMULA_MULTIPLY, ///< first x second 2^-left
    FUZZY_FORMULA_LEAST,
    FUZZY_FORMULA_MOST,
    FUZZY_FORMULA_ABSOLUTE, ///< of the top
    FUZZY_FORMULA_CURVE,    ///< value + span x curve(top); it begins at -FUZZY_FORMULA_LIMIT
    FUZZY_FORMULA_CODES,
} fuzzy_formula_code_t;

typedef enum {
    FUZZY_OP_INPUT,  ///< pushes the membership of an input's term
    FUZZY_OP_OUTPUT, ///< pushes what an output's term has been activated with
    FUZZY_OP_ANY,    ///< pushes 1
    FUZZY_OP_HEDGE,  ///< of the top
    FUZZY_OP_AND,    ///< of the two at the top
    FUZZY_OP_OR,
    FUZZY_OPS,
} fuzzy_op_t;

typedef struct {
    uint32_t magic;
    uint32_t crc; ///< CRC-32 (IEEE 802.3) of the words from here to the end
    uint32_t size_words;
    uint8_t inputs;
    uint8_t outputs;
    uint8_t blocks;
    uint8_t units; ///< 1: uHz and um/s2 to mA; 0: any other
    uint16_t inputs_offset;
    uint16_t outputs_offset;
    uint16_t blocks_offset;
    uint16_t rules_offset;
    uint16_t rules;
    uint16_t is_listed; ///< 1: rules are at most FUZZY_SYSTEM_LISTED, and their strengths are kept
    uint32_t reserved[9];
} fuzzy_system_t;

/// Pieces of x in rising order, from the least x that it is asked for.
/// degree 1: FUZZY_LINE_WORDS words each: last x of the piece, shift, c0 Q30, c1 Q24; 3: c2 and c3
/// Q24 more. value Q30 = c0 + t (c1 + t (c2 + t c3)), limited to 0 .. 2^30, with t Q31 = (x less
/// the piece's first) << shift.
typedef struct {
    uint16_t offset;
    uint8_t pieces;
    uint8_t degree;
} fuzzy_curve_t;

typedef struct {
    int32_t least;
    int32_t most;
    uint16_t terms_offset; ///< fuzzy_curve_t
    uint8_t terms;
    uint8_t first; ///< number of its first term among those of all inputs
    uint32_t reserved;
} fuzzy_system_input_t;

typedef struct {
    uint8_t method;      ///< fuzzy_system_method_t
    uint8_t aggregation; ///< fuzzy_norm_t
    uint8_t implication; ///< of terms
    uint8_t terms;
    int32_t value_default;
    int32_t origin;        ///< of the universe
    uint32_t span;         ///< of the universe, or 0: no bounds for a weighted value
    uint16_t places;       ///< at which sets are looked at
    uint16_t terms_offset; ///< fuzzy_curve_t over 0 .. 2^30 of the universe; or fuzzy_value_t
    uint8_t fraction;
    uint8_t is_by_rule; ///< sets: implied and aggregated rule by rule, else term by term
    uint8_t first;      ///< number of its first term among those of all outputs
    uint8_t reserved;
    int32_t offset; ///< added to a weighted sum, whose values count from 0
    uint32_t unused;
} fuzzy_system_output_t;

typedef struct {
    uint8_t kind;  ///< fuzzy_value_kind_t
    uint8_t input; ///< of the curve; of a formula its ops
    uint8_t shift; ///< of the products with the slopes, or of a formula
    uint8_t reserved;
    int32_t value;
    int32_t span;
    fuzzy_curve_t curve;
    uint32_t slopes_offset; ///< int32 an input; of a formula fuzzy_formula_op_t
} fuzzy_value_t;

typedef struct {
    uint8_t code;   ///< fuzzy_formula_code_t
    uint8_t number; ///< of the input or output
    uint8_t left;   ///< right shifts
    uint8_t right;
    int32_t value;
    int32_t span;
    fuzzy_curve_t curve;
} fuzzy_formula_op_t;

typedef struct {
    uint8_t and_norm; ///< fuzzy_norm_t
    uint8_t or_norm;
    uint8_t implication;
    uint8_t reserved;
} fuzzy_block_t;

/// Behind it, in half words, the lower one first, each part padded to whole words:
/// ops: fuzzy_op_t << 12 | number of the term among those of all inputs, or outputs; or hedge
/// conclusions: hedge << 12 | FUZZY_FRESH | FUZZY_ONLY_HEDGE | output << 8 | term. The hedge is of
/// what the one before made of the rule's strength, or, where it is fresh, of that itself.
typedef struct {
    uint8_t block;
    uint8_t ops;
    uint8_t conclusions;
    uint8_t reserved;
    uint32_t weight_q30;
} fuzzy_system_rule_t;

_Static_assert(sizeof(fuzzy_system_t) == 64, "16 words");
_Static_assert(sizeof(fuzzy_curve_t) == 4, "a word");
_Static_assert(sizeof(fuzzy_system_input_t) == 16, "4 words");
_Static_assert(sizeof(fuzzy_system_output_t) == 32, "8 words");
_Static_assert(sizeof(fuzzy_value_t) == 20, "5 words");
_Static_assert(sizeof(fuzzy_formula_op_t) == 16, "4 words");
_Static_assert(sizeof(fuzzy_block_t) == 4, "a word");
_Static_assert(sizeof(fuzzy_system_rule_t) == 8, "2 words");

/// Evaluates a table that fuzzy_system_check() accepts. Returns a bit for each output that no rule
/// reached, or whose sets are 0 everywhere: it has its default. Stack: about 1.8 kB. Bounded by the
/// table: some 60 instructions a term, 30 a condition, and for an output with sets 60 a place and
/// term (rule, where it is by rule).
uint32_t fuzzy_system_evaluate(const fuzzy_system_t *table, const int32_t *input, int32_t *output);

/// Whether the engine stays within its bounds with this table, whatever its inputs. words: how many
/// there are at `table`, which is aligned to 4 bytes. Bounded by the table's size; reads nothing
/// beyond it. Reasons as of fuzzy_table_check(); FUZZY_TABLE_CELL: a curve.
fuzzy_verdict_t fuzzy_system_check(const fuzzy_system_t *table, uint32_t words);

#endif
