/// Fuzzy systems for tests, each as a table, with points and what the engine answers there:
/// tests/gen/systems.py makes them of rule files.
#ifndef SYSTEM_CASES_H
#define SYSTEM_CASES_H

#include "fuzzy_system.h"

typedef struct {
    int32_t input[FUZZY_SYSTEM_MAX_INPUTS];
    uint32_t is_default; ///< bit an output
    int32_t output[FUZZY_MAX_OUTPUTS];
} system_point_t;

typedef struct {
    const char *name;
    const uint32_t *words;
    uint32_t count;
    const system_point_t *points;
    uint32_t points_count;
} system_case_t;

/// In this order.
enum {
    SYSTEM_EIGHT,
    SYSTEM_GAUSSIANS,
    SYSTEM_MAXIMA,
    SYSTEM_NORMS,
    SYSTEM_TSUKAMOTO,
    SYSTEM_VARIABLES,
    SYSTEM_CASES,
};

extern const system_case_t system_cases[SYSTEM_CASES];

static inline const fuzzy_system_t *system_table(const system_case_t *one) {
    return (const fuzzy_system_t *)(const void *)one->words;
}

#endif
