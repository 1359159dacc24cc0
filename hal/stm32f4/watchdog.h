/// The independent watchdog, on an oscillator of its own (32 kHz, 17 .. 47): once started nothing
/// but a reset stops it. Untested on silicon; what to measure: docs/howto/stm32f4.md.
#ifndef WATCHDOG_H
#define WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

#define WATCHDOG_MOST_MS 32000u

/// Starts it, or gives it another time. timeout_ms: 1 .. WATCHDOG_MOST_MS, at 32 kHz; what it is on
/// a chip may be two thirds or twice of that. Returns false iff the registers do not take it: then
/// the old time, or none, holds.
bool watchdog_start(uint32_t timeout_ms);

/// Only the supervisor calls it.
void watchdog_feed(void);

#endif
