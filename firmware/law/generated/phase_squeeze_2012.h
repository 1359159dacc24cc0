#ifndef PHASE_SQUEEZE_2012_H
#define PHASE_SQUEEZE_2012_H

#include <stdint.h>

/// For phase_table_check(): the words of a phase_table_t.
extern const uint32_t phase_squeeze_2012_table[157];

#endif
