/// The cases on random streams, a group each.
#ifndef STREAM_CASES_H
#define STREAM_CASES_H

#include "stream.h"

void stream_random_cases(stream_t *self); ///< random vibrations and parameters, all laws
void stream_table_cases(stream_t *self);  ///< parameter table, refusals, the rules on a grid
void stream_rules_cases(stream_t *self);  ///< rule tables are swapped
void stream_phase_cases(stream_t *self);  ///< law phase learns; pulse tables are swapped
void stream_storm_cases(stream_t *self);  ///< faults and an operator

/// Parameters of such a case, the first 20 with the defaults, and one after it was opened and they
/// were drawn.
void stream_random_draw(stream_t *self, uint32_t number);
void stream_random_run(stream_t *self);

#endif
