/// A rule base as a table of 32-bit words: a C constant, or loaded at run time. tools/src/quiesce/
/// rules/integers/table.py makes it; fuzzy_table_check() says whether it can be trusted.
///
/// Words: header (fuzzy_table_t), then at the offsets that it gives
///   cells    of each input, in ascending order over all of int32: fuzzy_cell_t, then one
///            fuzzy_ramp_t for each set that is not 0 there; every cell of an input takes the same
///            number of words. In a cell a set's membership is a straight line:
///              mu = (a + b * ((input - first) << shift)) >> 32, floor; 2^bits is 1
///   rules    fuzzy_rule_t
///   outputs  fuzzy_output_t; what its terms are, fuzzy_method_t says
#ifndef FUZZY_TABLE_H
#define FUZZY_TABLE_H

#include "fuzzy_math.h"

#define FUZZY_MAGIC UINT32_C(0x31545A46)
#define FUZZY_HEADER_WORDS 16u ///< of any table
#define FUZZY_MAX_WORDS 65535u
#define FUZZY_MAX_INPUTS 4u
#define FUZZY_MAX_OUTPUTS 4u
#define FUZZY_MAX_SETS 7u   ///< of an input, and of an output with sets
#define FUZZY_MAX_TERMS 64u ///< of an output with singletons
#define FUZZY_MAX_RULES 1024u
#define FUZZY_MAX_CONDITIONS 8u
#define FUZZY_MAX_FRACTION 8u
#define FUZZY_MIN_BITS 16u
#define FUZZY_MAX_BITS 28u
#define FUZZY_GRID_STRIDE 8u
#define FUZZY_NO_TERM 0xFFu
#define FUZZY_WEIGHT_ONE_q19 (UINT32_C(1) << 19)
#define FUZZY_WEIGHT_MASK UINT32_C(0xFFFFF)
#define FUZZY_EXPONENT_STEP 3u
/// For fuzzy_strength(): 28 bits of membership and 19 of weight, less what leaves 24 bits for a
/// singleton and room for so many rules. rules: 1 .. FUZZY_MAX_RULES.
#define FUZZY_STRENGTH_SHIFT(rules) (8u + 32u - (uint32_t)__builtin_clz(rules))

typedef enum {
    FUZZY_SUM,      ///< weighted average of singletons over the rules
    FUZZY_MAX,      ///< weighted average over terms, each with the strongest of its rules
    FUZZY_CENTROID, ///< of the largest of the sets, each cut at the strongest of its rules
} fuzzy_method_t;

/// What the engine can take for granted.
typedef enum {
    FUZZY_ANY,
    /// Two inputs, whose memberships add up to 1 everywhere, in 20 bits at most, with neighbouring
    /// numbers for neighbouring sets; one plain rule for each pair of sets; one output, a weighted
    /// sum. Its values, rows of FUZZY_GRID_STRIDE with one more row and column than there are sets,
    /// follow the header.
    FUZZY_PARTITION_SUM,
    FUZZY_PARTITION_MAX,      ///< likewise; twins_offset is valid
    FUZZY_PARTITION_CENTROID, ///< likewise; terms follow the header; every set reaches 1
    /// Two inputs, one output, no rules: the answers of any others at the nodes of a grid. An axis
    /// has cells + 1 fuzzy_node_t, its stride is FUZZY_NODE_WORDS. At output_offset[0] a value
    /// each, row by row of the first input, 16 bits, two in a word, the lower first. Between nodes
    /// lines in both directions; output = origin + value 2^(30 - fraction), to nearest.
    FUZZY_SURFACE,
} fuzzy_form_t;

/// A place on an axis of a surface. share of the way to the next, Q15 = ((input - at) << shift) *
/// scale >> 47, floor; scale << shift times that way is 2^62 at most. Of the last one `at` counts.
typedef struct {
    int32_t at;
    uint32_t shift;
    uint32_t scale;
} fuzzy_node_t;

#define FUZZY_NODE_WORDS 3u

/// Which of four neighbouring rules, a b in one row and c d in the next, share a term.
typedef enum {
    FUZZY_TWINS_NONE,
    FUZZY_TWINS_AB,
    FUZZY_TWINS_AC,
    FUZZY_TWINS_AD,
    FUZZY_TWINS_BC,
    FUZZY_TWINS_BD,
    FUZZY_TWINS_CD,
    FUZZY_TWINS_AB_CD,
    FUZZY_TWINS_AC_BD,
    FUZZY_TWINS_AD_BC,
    FUZZY_TWINS_ABC,
    FUZZY_TWINS_ABD,
    FUZZY_TWINS_ACD,
    FUZZY_TWINS_BCD,
    FUZZY_TWINS_ALL,
} fuzzy_twins_t;

typedef struct {
    uint16_t offset; ///< words from the table's start
    uint8_t cells;
    uint8_t stride; ///< words of a cell
} fuzzy_axis_t;

typedef struct {
    uint32_t magic;
    uint32_t crc; ///< CRC-32 (IEEE 802.3) of the words from here to the end
    uint32_t size_words;
    uint8_t inputs;
    uint8_t outputs;
    uint8_t bits;
    uint8_t form; ///< fuzzy_form_t
    fuzzy_axis_t axis[FUZZY_MAX_INPUTS];
    uint16_t rules_offset;
    uint16_t rules;
    uint32_t output_offset[FUZZY_MAX_OUTPUTS];
    uint32_t one;          ///< 2^bits
    int32_t origin;        ///< of a partition's output, or of a surface's
    uint16_t twins_offset; ///< of a PARTITION_MAX: fuzzy_twins_t, in the order of its values
    uint8_t fraction;      ///< of a partition's output, or of a surface's
    uint8_t units;         ///< 1: uHz and um/s2 to mA; 0: any other
} fuzzy_table_t;

typedef struct {
    int32_t last; ///< inclusive; INT32_MAX in the last cell
    int32_t first;
    uint32_t shift;
    uint32_t ramps;
} fuzzy_cell_t;

typedef struct {
    uint32_t a_low;
    int32_t a_high;
    int32_t b;
    uint32_t set;
} fuzzy_ramp_t;

/// The two ramps of a cell of a grid; one that is not there is 0 everywhere.
typedef struct {
    fuzzy_cell_t cell;
    fuzzy_ramp_t ramp[2];
} fuzzy_pair_cell_t;

/// head: weight Q19 in bits 0..19, "or" bit 20, in bits 21..23 by how many times
/// FUZZY_EXPONENT_STEP bits the weight is smaller, number of conditions from bit 24.
/// condition: set | input << 3 | negated << 7.
typedef struct {
    uint32_t head;
    uint8_t condition[FUZZY_MAX_CONDITIONS];
    uint8_t conclusion[FUZZY_MAX_OUTPUTS]; ///< term of each output or FUZZY_NO_TERM
} fuzzy_rule_t;

typedef struct {
    uint8_t method;
    uint8_t terms;
    uint16_t layers; ///< of a centroid
    int32_t value_default;
    int32_t origin;        ///< least value that the output can take
    uint32_t span;         ///< of a centroid's universe, in counts
    uint32_t terms_offset; ///< singletons less the origin; or peaks of the sets, then layers
    uint32_t term_layers;  ///< of the sets themselves; those of overlaps follow; 0: stacked
    uint32_t fraction;     ///< singletons count 2^-fraction of the output's
    uint32_t reserved;
} fuzzy_output_t;

/// Marks of a layer. The last two where sets are stacked: the output is cut where sets begin, end,
/// bend or cross, and each stretch has the layers of its sets, from the highest set down.
#define FUZZY_SKEWED_LEFT 1u
#define FUZZY_BEGINS_STRETCH 2u
#define FUZZY_BEGINS_SET 4u

/// A stretch of the height of a set, or of the overlap of two, in which its flanks are straight
/// (tools/src/quiesce/rules/integers/output_shapes.py has the equations).
typedef struct {
    uint8_t first;  ///< term, from left to right
    uint8_t second; ///< the same, or the one that overlaps it
    uint8_t marks;  ///< FUZZY_SKEWED_LEFT ...
    uint8_t steep;  ///< flanks' narrowing and skews are 2^-steep of their values; 0 in a partition
    uint32_t start; ///< height, 2^-bits
    uint32_t height;
    fuzzy_flanks_t flanks; ///< shares of the span
} fuzzy_layer_t;

_Static_assert(sizeof(fuzzy_table_t) == 64, "16 words");
_Static_assert(sizeof(fuzzy_rule_t) == 16, "4 words");
_Static_assert(sizeof(fuzzy_output_t) == 32, "8 words");
_Static_assert(sizeof(fuzzy_layer_t) == 32, "8 words");
_Static_assert(sizeof(fuzzy_pair_cell_t) == 48, "12 words");
_Static_assert(sizeof(fuzzy_node_t) == 4u * FUZZY_NODE_WORDS, "3 words");

static inline const void *fuzzy_at(const fuzzy_table_t *table, uint32_t offset_words) {
    return (const uint32_t *)(const void *)table + offset_words;
}

/// Whether so many words of a table from an offset on lie behind its header and within it.
static inline bool fuzzy_is_inside(const fuzzy_table_t *table, uint32_t offset, uint32_t words) {
    return offset >= FUZZY_HEADER_WORDS && offset <= table->size_words &&
           words <= table->size_words - offset;
}

/// Why a table is refused. Numbers are for logs and are never reused.
typedef enum {
    FUZZY_TABLE_OK = 0,
    FUZZY_TABLE_SIZE = 1,   ///< shorter than it says, or no table's size
    FUZZY_TABLE_MAGIC = 2,  ///< not a table, or of another version
    FUZZY_TABLE_CRC = 3,    ///< damaged
    FUZZY_TABLE_SHAPE = 4,  ///< numbers of inputs, outputs, rules, bits
    FUZZY_TABLE_CELL = 5,   ///< cells do not cover int32, or a membership leaves 0..1
    FUZZY_TABLE_RULE = 6,   ///< a rule names what is not there
    FUZZY_TABLE_OUTPUT = 7, ///< a term out of range
} fuzzy_verdict_t;

/// Whether the engine stays within its bounds with this table, whatever its inputs: every index,
/// every shift, every membership at both ends of every cell, every sum. words: how many there are
/// at `table`, which is aligned to 4 bytes. Bounded by the table's size; reads nothing beyond it.
fuzzy_verdict_t fuzzy_table_check(const fuzzy_table_t *table, uint32_t words);

/// The rest of it, of a table whose first FUZZY_HEADER_WORDS words are there at least and whose
/// magic, size and CRC have been found right.
fuzzy_verdict_t fuzzy_table_check_summed(const fuzzy_table_t *table);

/// The same of a FUZZY_SURFACE.
fuzzy_verdict_t fuzzy_surface_check(const fuzzy_table_t *table);

#endif
