/// Rule bases for tests, each as a table, as straight-line C where that exists, and with points at
/// which the answer in real numbers is known: tests/gen/rules.py makes them of rule files.
#ifndef RULE_CASES_H
#define RULE_CASES_H

#include "fuzzy.h"

typedef struct {
    int32_t input[FUZZY_MAX_INPUTS];
    uint32_t is_default;                     ///< bit an output
    int64_t expected_q16[FUZZY_MAX_OUTPUTS]; ///< counts
    int64_t allowed_q16[FUZZY_MAX_OUTPUTS];  ///< error that the rounding of the integers explains
} rule_point_t;

typedef struct {
    const char *name;
    const uint32_t *words;
    uint32_t count;
    fuzzy_function_t straight; ///< NULL: the base has no such form
    const rule_point_t *points;
    uint32_t points_count;
    int32_t low[FUZZY_MAX_OUTPUTS]; ///< least and greatest value where some rule fires
    int32_t high[FUZZY_MAX_OUTPUTS];
    uint32_t defaults; ///< outputs that some point leaves at their default, a bit each
} rule_case_t;

/// In this order.
enum {
    CASE_SUM_Q15,
    CASE_SUM_PHYSICAL,
    CASE_SUM_WIDE,
    CASE_SUM_FINE,
    CASE_MAX_Q15,
    CASE_MAX_PHYSICAL,
    CASE_CENTROID_Q15,
    CASE_CENTROID_PHYSICAL,
    CASE_OVERLAPS,
    CASE_STACKED,
    CASE_SEVEN,
    CASE_GRID_Q15,
    CASE_GRID_PHYSICAL,
    CASE_GENERAL,
    CASE_FOUR,
    CASE_LIMITS,
    CASE_ONE,
    RULE_CASES,
};

extern const rule_case_t rule_cases[RULE_CASES];

static inline const fuzzy_table_t *case_table(const rule_case_t *one) {
    return (const fuzzy_table_t *)(const void *)one->words;
}

#endif
