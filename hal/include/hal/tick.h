/// Periodic control tick.
#ifndef HAL_TICK_H
#define HAL_TICK_H

#include <stdbool.h>
#include <stdint.h>

typedef struct hal_tick hal_tick_t;

/// Starts the timer. rate_Hz: 1 .. 100000. Returns false iff the rate cannot be made exactly.
bool hal_tick_start(hal_tick_t *tick, uint32_t rate_Hz);

/// Ticks that have elapsed since the last call: 0, 1, or more after an overrun. Never blocks.
uint32_t hal_tick_elapsed(hal_tick_t *tick);

#endif
