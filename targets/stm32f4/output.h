/// The board's own output stage: a bridge with its current loop, a DAC, or none. The current loop
/// runs in the ADC's interrupt; the rest is called by the tick.
#ifndef OUTPUT_H
#define OUTPUT_H

#include "clocks.h"
#include "quiesce.h"

/// Off. An emulator (CLOCK_ABSENT) has no output stage. Call with interrupts held.
void output_open(const clocks_t *clocks);

/// What the bridge has measured, for the tick's step; where its interrupt has stopped for two
/// calls, something has cut it off, or a coil is found open or short (told once), the driver has
/// failed. Without a bridge nothing is measured.
void output_measure(quiesce_driver_t *driver);

/// The command of this tick. An output stage that has been cut off stays so until the controller
/// has switched it off and on again.
void output_write(int32_t current_mA, bool is_enabled);

/// Off, whatever else is the matter. For the start and for a fault of the processor.
void output_cut(void);

/// Cycles of the longest interrupt of the current loop since the last call (cycles.h).
uint32_t output_longest_cycles(void);

/// Whether all that must run by interrupt has run since the last call.
bool output_is_alive(void);

#endif
