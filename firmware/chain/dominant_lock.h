/// The lock on the dominant component: when it takes hold and when it lets go. For laws that ask
/// for it (law_t.lock); a build without one holds none of it.
///
/// It locks on to what the estimator trusts, holds on by itself, and lets go where the component
/// leaves the band by more than a sixteenth of its edge. Half cycles that are alike make a lock,
/// too, sooner than the estimator can: three where the vibration has just changed, five at the
/// start. In broadband motion some are always alike. So each such lock makes the next one twice as
/// hard, until one lasts for 16 half cycles or the estimator trusts a component. Formats as in
/// lock_in.h.
#ifndef DOMINANT_LOCK_H
#define DOMINANT_LOCK_H

#include "condition.h"
#include "half_cycles.h"
#include "lock_in.h"
#include "predictor.h"

#define DOMINANT_LOCK_FIRST 3u ///< half_cycles_tone_t.alike: five half cycles

typedef struct {
    lock_in_t in;
    half_cycles_t half_cycles;
    uint8_t least_alike;       ///< that make the next lock, as half_cycles_tone_t.alike
    uint32_t lowest_step_turn; ///< of the band, a tick
    uint32_t highest_step_turn;
    int32_t min_accel_um_s2; ///< RMS
} dominant_lock_state_t;

/// What is known in this tick.
typedef struct {
    const condition_out_t *sample;
    int32_t velocity_um_s;
    int32_t rms_um_s2;
    uint32_t lost_ticks;          ///< just before this one
    const predictor_tone_t *tone; ///< that the estimator has just published and trusts, or NULL
} dominant_lock_in_t;

/// What law.h names.
typedef struct dominant_lock dominant_lock_t;
struct dominant_lock {
    /// One tick. Bounded: lock_in and half_cycles, some 30 instructions more.
    void (*step)(dominant_lock_state_t *self, const dominant_lock_in_t *in);
};

/// Unlocked. The band: 2^32 f / tick_rate.
static inline void dominant_lock_init(dominant_lock_state_t *self, uint32_t tick_rate_Hz,
                                      uint32_t lowest_step_turn, uint32_t highest_step_turn,
                                      int32_t min_accel_um_s2) {
    lock_in_init(&self->in, tick_rate_Hz);
    half_cycles_reset(&self->half_cycles);
    self->least_alike = DOMINANT_LOCK_FIRST;
    self->lowest_step_turn = lowest_step_turn;
    self->highest_step_turn = highest_step_turn;
    self->min_accel_um_s2 = min_accel_um_s2;
}

#endif
