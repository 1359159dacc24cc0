/// Fuzzy inference over a const rule table: two inputs with four sets each, singleton outputs.
///
/// Sets are trapezoids over a physical integer; a shoulder holds 1 beyond its plateau. AND is the
/// minimum; every rule adds its strength to the sum and its strength times its singleton to the
/// weighted sum; output = weighted sum / sum. No rule fires: the table's default, flagged.
/// Formats: inputs int32 in the table's unit; memberships Q15 (32768 = 1), floor; output mA,
/// rounded to nearest. Sums: 16 rules x 2^15 x 2^15 mA fit 35 bits. Bounded, about 300
/// instructions. Rules are read at run time: this is inference, not a lookup surface.
#ifndef FUZZY_H
#define FUZZY_H

#include "fixq.h"

#define FUZZY_SETS 4
#define FUZZY_OUTPUTS 5
#define FUZZY_ONE_q15 32768

/// Trapezoid: 0 at left_foot, 1 from left_top to right_top, 0 at right_foot. rise and fall are the
/// slopes, FUZZY_SLOPE of their two points; 0 for a shoulder (then the foot equals the top).
typedef struct {
    int32_t left_foot;
    int32_t left_top;
    int32_t right_top;
    int32_t right_foot;
    uint32_t rise;
    uint32_t fall;
} fuzzy_set_t;

/// Q15 membership per unit of the input, Q31: 2^46 / (high - low), rounded up, so that high
/// gives 1.
#define FUZZY_SLOPE(low, high)                                                                     \
    ((uint32_t)(((INT64_C(1) << 46) + ((high) - (low)) - 1) / ((high) - (low))))

/// A triangle, and the two shoulders that close a row of triangles.
#define FUZZY_TRIANGLE(left, top, right)                                                           \
    { (left), (top), (top), (right), FUZZY_SLOPE(left, top), FUZZY_SLOPE(top, right) }
#define FUZZY_LEFT_SHOULDER(top, right)                                                            \
    { INT32_MIN, INT32_MIN, (top), (right), 0, FUZZY_SLOPE(top, right) }
#define FUZZY_RIGHT_SHOULDER(left, top)                                                            \
    { (left), (top), INT32_MAX, INT32_MAX, FUZZY_SLOPE(left, top), 0 }

/// A rule base. Feet of one set lie at least 2^15 units apart (the slope then fits 32 bits).
typedef struct {
    fuzzy_set_t row[FUZZY_SETS];          ///< first input
    fuzzy_set_t column[FUZZY_SETS];       ///< second input
    uint8_t rule[FUZZY_SETS][FUZZY_SETS]; ///< index of the output singleton
    int32_t singleton_mA[FUZZY_OUTPUTS];  ///< 0 .. 32767
    int32_t default_mA;                   ///< where no rule fires
} fuzzy_table_t;

typedef struct {
    int32_t current_mA;
    uint32_t rules_fired; ///< bit row * FUZZY_SETS + column; 0: the default was used
} fuzzy_out_t;

/// Membership of one set at x, Q15.
uint32_t fuzzy_membership_q15(const fuzzy_set_t *set, int32_t x);

/// Evaluates the rule base at (row_input, column_input); any values.
fuzzy_out_t fuzzy_evaluate(const fuzzy_table_t *table, int32_t row_input, int32_t column_input);

#endif
