/// Straight-line C of fuzzy systems for tests, with points and what it answers there:
/// tests/gen/straight.py makes it of rule files.
#ifndef STRAIGHT_CASES_H
#define STRAIGHT_CASES_H

#include <stdint.h>

enum {
    STRAIGHT_MINIMA,
    STRAIGHT_PRODUCT,
    STRAIGHT_SUGENO,
    STRAIGHT_WEAK,
    STRAIGHT_CASES,
    STRAIGHT_MAX_INPUTS = 4,
    STRAIGHT_MAX_OUTPUTS = 4,
};

typedef struct {
    int32_t input[STRAIGHT_MAX_INPUTS];
    uint32_t is_default; ///< bit an output
    int32_t output[STRAIGHT_MAX_OUTPUTS];
} straight_point_t;

typedef struct {
    const char *name;
    uint32_t (*function)(const int32_t *input, int32_t *output);
    uint32_t outputs;
    const straight_point_t *points;
    uint32_t points_count;
} straight_case_t;

/// In the order of the names above.
extern const straight_case_t straight_cases[STRAIGHT_CASES];

#endif
