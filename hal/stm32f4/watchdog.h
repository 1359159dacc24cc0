/// The independent watchdog, on an oscillator of its own (32 kHz, 17 .. 47): once started nothing
/// but a reset stops it. Untested on silicon; what to measure: docs/howto/stm32f4.md.
#ifndef WATCHDOG_H
#define WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

#define WATCHDOG_MOST_MS 32000u

/// Starts it, waits until the time holds, 60 ms at the most at 168 MHz, and feeds it. timeout_ms:
/// 1 .. WATCHDOG_MOST_MS, at 32 kHz; what it is on a chip may be two thirds or twice of that.
/// Returns false iff the time does not hold yet: it runs, by the time that it had.
bool watchdog_start(uint32_t timeout_ms);

/// Another time, without waiting: call again until it returns true, and feed then. The hardware
/// takes up to 48 ms; meanwhile, and for a timeout_ms out of its range, it returns false and the
/// old time holds.
bool watchdog_set(uint32_t timeout_ms);

/// The supervisor calls it, and who has set another time.
void watchdog_feed(void);

#endif
