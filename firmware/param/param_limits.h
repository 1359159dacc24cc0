/// What parameters are held to, in index order (generated source, see parameters.toml).
#ifndef PARAM_LIMITS_H
#define PARAM_LIMITS_H

#include "quiesce_params.h"

typedef struct {
    int32_t min;
    int32_t max;
    int32_t default_value;
    uint8_t first_choice; ///< of param_choices
    uint8_t choice_count; ///< 0: all of min .. max
    bool is_live;
} param_limits_t;

extern const int32_t param_choices[];
extern const param_limits_t param_limits[QUIESCE_PARAM_COUNT];

#endif
