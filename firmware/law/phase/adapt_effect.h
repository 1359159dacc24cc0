/// What a pulse does to the vibration, measured over half cycles: how far the displacement reaches,
/// and the RMS acceleration. A measurement is made in two parts: what they differ by is noise,
/// or has not settled.
///
/// Reach is half peak-to-peak displacement times (2 pi f)^2, from the fundamental and the third
/// harmonic, which counts a ninth. Formats: um/s2. Bounded: an addition of sums at the end of a
/// half cycle, then one division, root or angle a tick, and 16 ticks of search.
#ifndef ADAPT_EFFECT_H
#define ADAPT_EFFECT_H

#include "harmonics.h"

/// What a measurement says.
typedef struct {
    uint32_t reach_um_s2;
    uint32_t rms_um_s2;
} adapt_effect_t;

/// A measurement under way.
typedef struct {
    bool is_collecting;   ///< half cycles are added up
    uint8_t done;         ///< parts that are finished
    uint8_t taken;        ///< the same, without what adapt_meter_go_on drops
    uint8_t halves;       ///< half cycles in the sums
    uint8_t stage;        ///< of the work on this one; 0: none
    harmonic_sums_t sums; ///< so far
    harmonic_parts_t parts;
    uint32_t peak_turn; ///< where the fundamental is largest
    harmonic_span_t span;
    adapt_effect_t part[2]; ///< that come out
} adapt_meter_t;

/// Starts anew.
void adapt_meter_reset(adapt_meter_t *self);

/// One tick. half: half a cycle that ended in it, or NULL; the first one counts as begun too early.
/// A part is whole cycles of at least part_ticks: what halves differ by cancels. Returns true iff
/// two parts are complete.
bool adapt_meter_step(adapt_meter_t *self, const harmonic_sums_t *half, uint32_t part_ticks);

/// The first part is dropped for another one after the second.
void adapt_meter_go_on(adapt_meter_t *self);

/// The mean of both parts.
adapt_effect_t adapt_meter_effect(const adapt_meter_t *self);

#endif
