/// A rule base by itself, for tools that draw and check it.
#ifndef QUIESCE_RULES_H
#define QUIESCE_RULES_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Current in mA at a frequency and an RMS acceleration. table: rules that quiesce_table_use takes
/// where law fuzzy runs; NULL: those that ship. *rules_fired (may be NULL) receives a bit per rule
/// in its file's order, the first 32.
int32_t quiesce_rules_current_mA(const uint32_t *table, int32_t freq_uHz, int32_t rms_um_s2,
                                 uint32_t *rules_fired);

#ifdef __cplusplus
}
#endif

#endif
