/// A lock on one component: its phase at every tick, followed from cycle to cycle, and what each
/// half cycle of the acceleration holds of it and of its third harmonic.
///
/// The phase runs on at the known frequency. Each half cycle is correlated with cosine and sine of
/// the phase; the angle that comes out corrects phase (by half of it) and frequency (by a fifth of
/// it a half cycle): a second-order phase-locked loop that settles within a few cycles, follows
/// sweeps, and knows a change of amplitude from a change of frequency. The tracker finds components
/// and says when they can be trusted; the lock holds on to one of them while the amplitude changes,
/// as it does whenever a law changes what it does.
///
/// It is lost when a half cycle's angle is above 60 degrees, when its amplitude is below a quarter
/// of the last one's, or when the samples contradict the last half cycle: the mean square of what
/// it does not explain, low-passed at 1.3 times the frequency, over about a quarter of a cycle,
/// exceeds half of what it held.
///
/// Formats: phases in turns Q32; accelerations um/s2, |x| < 2^29. Bounded: about 110 instructions
/// a tick, 150 more in the few ticks after the end of a cycle.
#ifndef LOCK_IN_H
#define LOCK_IN_H

#include "harmonics.h"

enum { LOCK_IN_MOST_SKIPPED = 8 }; ///< ticks

typedef struct {
    bool is_locked;
    bool has_half;        ///< that work was finished in this tick
    uint8_t stage;        ///< of the work on the last half cycle, a division a tick
    uint32_t halves;      ///< half cycles since locked, saturating
    uint32_t phase_turn;  ///< now: the component is amp x cos(phase)
    uint32_t step_turn;   ///< a tick
    uint32_t half_turn;   ///< twice the phase since it began: it ends where this wraps
    uint32_t memory_q16;  ///< of unexplained: one over the ticks in a quarter of a cycle
    harmonic_sums_t half; ///< the one that is running
    harmonic_sums_t last; ///< the last whole half cycle
    harmonic_parts_t found;
    harmonic_sums_t before;    ///< the half cycle before the last: a mean takes both
    int32_t mean_um_s2;        ///< taken off the samples
    harmonic_parts_t expected; ///< of the next samples: what the last half cycle held
    uint32_t amp_um_s2;        ///< of its fundamental
    uint32_t shift;            ///< for squares: so many bits are dropped
    int32_t slow_q8;           ///< low-passed difference, shifted
    int64_t power;             ///< mean square of the fundamental, shifted
    int64_t unexplained;       ///< running mean square of the difference
} lock_in_t;

/// Unlocked.
static inline void lock_in_init(lock_in_t *self) {
    *self = (lock_in_t){0};
}

/// Locks on to a component as of this tick. Takes effect with the next tick.
/// step_turn: its frequency, 2^32 f / tick_rate, 1 .. 60 Hz; mean_um_s2: constant part of the
/// samples, roughly.
void lock_in_acquire(lock_in_t *self, uint32_t phase_turn, uint32_t step_turn, int32_t mean_um_s2);

/// Lets go.
void lock_in_release(lock_in_t *self);

/// Ticks that went by without a call; each counts as one with a held sample.
/// Bounded: some 110 instructions for each of up to LOCK_IN_MOST_SKIPPED ticks; after more it lets
/// go, since the component may have changed meanwhile.
void lock_in_skip(lock_in_t *self, uint32_t ticks);

/// One tick; a held sample (!is_good) counts as one that was expected. Does nothing while unlocked.
/// may_work: on the last half cycle; else that waits for a tick that has less to do.
void lock_in_step(lock_in_t *self, int32_t accel_um_s2, bool is_good, bool may_work);

#endif
