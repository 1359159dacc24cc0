/// Quantities of the view by a number, for tables that name what they work with, and for sensors.
///
/// A signal's word: bits 0 .. 7 its quantity, a quiesce_sense_t or VIEW_SIGNAL_CURRENT; bits 8 ..
/// 15 the body or damper, 0 of the supply; the others are 0.
#ifndef VIEW_SIGNAL_H
#define VIEW_SIGNAL_H

#include "quiesce_board.h"
#include "view.h"

enum { VIEW_SIGNAL_CURRENT = QUIESCE_SENSES, VIEW_SIGNAL_QUANTITIES };

/// Of tables of trackers only: the force that the law demands, in no view.
#define VIEW_SIGNAL_DEMAND 64u

/// Where a quantity is in view_t, of the first body or damper, and its first bit.
typedef struct {
    uint16_t offset;
    uint8_t stride; ///< to the next body or damper
    uint8_t valid;  ///< number of the bit: QUIESCE_VALID_
} view_quantity_t;

extern const view_quantity_t view_quantity[VIEW_SIGNAL_QUANTITIES];

/// An input of a table: its value, limited to -limit .. limit, x 2^shift.
typedef struct {
    uint32_t signal;
    int32_t limit;  ///< in the signal's unit, > 0
    uint32_t shift; ///< limit x 2^shift < 2^30
} view_input_t;

#define VIEW_INPUT_WORDS 3u
#define VIEW_INPUTS_MAX 12u

/// Whether all of them are as this header says, each of at most QUIESCE_MAX_BODIES or
/// QUIESCE_MAX_DAMPERS places.
bool view_inputs_are_good(const view_input_t *inputs, uint32_t count);

/// VIEW_ bits of good inputs.
uint64_t view_inputs_need(const view_input_t *inputs, uint32_t count);

/// Reads good ones, all of places that the build has. About 15 instructions each.
void view_inputs_read(const view_input_t *inputs, uint32_t count, const view_t *view, int32_t *out);

/// Whether this is a signal of the view, of at most QUIESCE_MAX_BODIES or QUIESCE_MAX_DAMPERS
/// places.
bool view_signal_is_good(uint32_t signal);

/// The VIEW_ bit of a good signal.
uint64_t view_signal_needs(uint32_t signal);

/// The value of a good signal of a place that the build has.
int32_t view_signal_value(const view_t *view, uint32_t signal);

/// The bit that stands for damper i itself: its current, known wherever there is that damper.
static inline uint64_t view_needs_damper(uint32_t i) {
    return VIEW_CURRENT << i;
}

#endif
