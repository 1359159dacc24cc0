/// hal/tick.h on TIM5, which counts freely over 32 bits: no interrupt, no drift. Ask at least every
/// 51 s (at 84 MHz) for what has elapsed. Untested on silicon; what to measure:
/// docs/howto/stm32f4.md.
#ifndef TICK_STM32F4_H
#define TICK_STM32F4_H

#include "hal/tick.h"

struct hal_tick {
    uint32_t clock_Hz; ///< of the timer, set by the caller before hal_tick_start
    uint32_t period_counts;
    uint32_t last_count; ///< at the last tick
};

/// The count, of clock_Hz, once the tick has been started.
uint32_t tick_stm32f4_count(void);

/// Cycles of a clock of core_Hz until the next tick is due; 0: it is.
uint32_t tick_stm32f4_left(const hal_tick_t *tick, uint32_t core_Hz);

#endif
