/// The lock on the dominant component: when it takes hold and when it lets go. For laws that ask
/// for it (law_t.lock); a build without one holds none of it.
///
/// It locks on to what the estimator trusts, holds on by itself, and lets go where the component
/// leaves the band by more than a sixteenth of its edge. Half cycles that are alike make a lock,
/// too, sooner than the estimator can: three where the vibration has just changed, five at the
/// start. In broadband motion some are always alike. So each such lock makes the next one twice as
/// hard, until one lasts for 16 half cycles or the estimator trusts a component.
///
/// Other components that the estimator knows, but for odd harmonics, are taken off the samples
/// that the lock follows: beside one of a third of its size it would be lost again and again.
/// Where one of them displaces more than the dominant one does, by a quarter, there is no lock:
/// what is right for one is not for the other. Formats as in lock_in.h.
#ifndef DOMINANT_LOCK_H
#define DOMINANT_LOCK_H

#include "condition.h"
#include "half_cycles.h"
#include "lock_in.h"
#include "predictor.h"
#include "view.h"

#define DOMINANT_LOCK_FIRST 3u ///< half_cycles_tone_t.alike: five half cycles

typedef struct {
    lock_in_t in;
    half_cycles_t half_cycles;
    uint8_t least_alike;       ///< that make the next lock, as half_cycles_tone_t.alike
    uint8_t others;            ///< bit i: predictor_t.tone[i] is not the lock's
    bool is_crowded;           ///< one of them displaces too much beside it
    bool has_news;             ///< in the last tick: looked at in this one, which has less to do
    uint32_t lowest_step_turn; ///< of the band, a tick
    uint32_t highest_step_turn;
    int32_t min_accel_um_s2;   ///< RMS
    uint32_t latency_q8;       ///< ticks
    uint32_t corner_step_turn; ///< a tick; 0: none
} dominant_lock_state_t;

/// What is known in this tick.
typedef struct {
    const condition_out_t *sample;
    int32_t velocity_um_s;
    int32_t rms_um_s2;
    uint32_t lost_ticks;      ///< just before this one
    const predictor_t *known; ///< the estimator's components, as of this tick
    bool has_published;       ///< they are new
    bool is_busy;             ///< the tick has other work: that on half cycles can wait
    bool is_valid;            ///< the dominant one is trusted
} dominant_lock_in_t;

/// What it is for.
typedef struct {
    uint32_t tick_rate_Hz;
    int32_t band_low_mHz;
    int32_t band_high_mHz;
    int32_t min_accel_um_s2; ///< RMS
    int32_t latency_us;      ///< from a motion to the current that answers it, but for the coil
    int32_t corner_mHz;      ///< of the sensor's high-pass of first order; 0: none
} dominant_lock_cfg_t;

/// What law.h names, and whatever there is of a lock comes through it: a build without a law that
/// has one holds nothing of it.
typedef struct dominant_lock dominant_lock_t;
struct dominant_lock {
    /// Unlocked.
    void (*init)(dominant_lock_state_t *self, const dominant_lock_cfg_t *cfg);
    /// One tick. Bounded: lock_in and half_cycles, some 30 instructions more, and 15 for each other
    /// component.
    void (*step)(dominant_lock_state_t *self, const dominant_lock_in_t *in);
    /// Writes phase, frequency and half cycle of view->tone, and VIEW_LOCK iff it is locked.
    void (*show)(const dominant_lock_state_t *self, view_t *view);
};

#endif
