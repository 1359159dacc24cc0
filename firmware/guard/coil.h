/// A coil by the voltage across it, where its resistance is known.
///
/// In a coil that is short the driver makes its current with next to no voltage: less than a
/// quarter of resistance times current. Judged only while command and current agree, because a
/// current that falls may do so against any voltage. The count is leaky: a good tick takes back a
/// quarter of a bad one. Products in 64 bits, uV. Bounded, about 30 instructions, 3 without a
/// resistance.
#ifndef COIL_H
#define COIL_H

#include "fixq.h"

typedef struct {
    int32_t resistance_mohm; ///< 0: not known, nothing is judged
    int32_t error_mA;        ///< command and current agree within it; less than twice is no current
    uint32_t fault_ticks;
    uint32_t bad; ///< leaky, 4 a bad tick
} coil_t;

void coil_init(coil_t *self, int32_t resistance_mohm, int32_t error_mA, uint32_t fault_ticks);

/// A tick in which current and voltage were measured. Returns true iff the coil is short.
bool coil_is_short(coil_t *self, int32_t command_mA, int32_t current_mA, int32_t voltage_mV);

/// Whether a coil without current is open: at least half of what the expected current needs is
/// there. Else the driver gives nothing.
bool coil_is_open(const coil_t *self, int32_t expected_mA, int32_t voltage_mV);

#endif
