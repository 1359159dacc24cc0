// What the walk (walk.c) needs of a rule base, in real numbers; the values are generated text.
#ifndef MODEL_H
#define MODEL_H

#include "fuzzy.h"

typedef struct {
    double x;
    double mu;
} model_point_t;

typedef struct {
    int count;
    const model_point_t *points;
} model_set_t;

// value = origin + n * lsb_up / lsb_down
typedef struct {
    double minimum, maximum, origin, lsb_up, lsb_down;
    int64_t first, last; // integers that the walk covers
    int sets;
    const model_set_t *set;
    int64_t sample_count;
    const int64_t *samples;
} model_input_t;

typedef struct {
    int input, set;
    bool negated;
} model_condition_t;

typedef struct {
    bool is_or;
    int count;
    model_condition_t condition[FUZZY_MAX_CONDITIONS];
    int conclusion[FUZZY_MAX_OUTPUTS]; // -1: none
    double weight;
} model_rule_t;

typedef struct {
    double origin, lsb_up, lsb_down;
    int method; // fuzzy_method_t
    int terms;
    const double *singleton;
    const model_set_t *set;
    int breakpoints;
    const double *breakpoint; // of the sets, inside the universe, with its ends
} model_output_t;

#include "model_values.h"

#endif
