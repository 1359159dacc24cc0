/// State of law fuzzy_selftune; contents are private to it.
#ifndef SELFTUNE_STATE_H
#define SELFTUNE_STATE_H

#include "rule_base.h"

typedef struct {
    rule_base_t rules;
    int64_t current_mA_q20; ///< tuned
} selftune_t;

#endif
