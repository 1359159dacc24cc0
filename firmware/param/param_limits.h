/// What parameters are held to, in index order (generated source, see parameters.toml).
#ifndef PARAM_LIMITS_H
#define PARAM_LIMITS_H

#include "quiesce_params.h"

typedef struct {
    int32_t min;
    int32_t max;
    int32_t default_value;
} param_limits_t;

/// A value that a parameter may have. One without any may have all of min .. max.
typedef struct {
    int16_t value;
    uint8_t index; ///< of the parameter
} param_choice_t;

extern const param_limits_t param_limits[QUIESCE_PARAM_COUNT];
extern const param_choice_t param_choices[];
extern const uint32_t param_choice_count;
extern const uint32_t param_live[]; ///< bit index % 32 of word index / 32

#endif
