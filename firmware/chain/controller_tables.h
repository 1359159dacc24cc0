/// What tables.c does with a controller beyond its public calls: words whose CRC has just been
/// found right (is_summed) are not summed again.
#ifndef CONTROLLER_TABLES_H
#define CONTROLLER_TABLES_H

#include "quiesce.h"

/// What controller_use_table would say.
quiesce_table_verdict_t controller_check_table(const quiesce_t *self, const uint32_t *words,
                                               uint32_t count, bool is_summed);

/// As quiesce_table_use.
quiesce_table_verdict_t controller_use_table(quiesce_t *self, const uint32_t *words, uint32_t count,
                                             bool is_summed);

#endif
