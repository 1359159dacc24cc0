/// Table of all parameters, in index order (generated source, see parameters.toml).
#ifndef PARAM_TABLE_H
#define PARAM_TABLE_H

#include "quiesce_params.h"

extern const quiesce_param_info_t param_table[QUIESCE_PARAM_COUNT];

#endif
