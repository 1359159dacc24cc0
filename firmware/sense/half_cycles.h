/// The quickest look at a vibration: the times between zero crossings of its velocity. Three half
/// cycles in a row that are alike make a component: less accurate than the estimator's, but there
/// within two cycles of a change, and with the phase of the motion as it is, whatever it is made
/// of.
///
/// Velocity counts rather than acceleration: harmonics weigh less in it. A crossing counts once the
/// velocity has gone an eighth of its last peak beyond zero.
///
/// Formats: times in ticks Q8; phases in turns Q32. Bounded: about 15 instructions a tick, 100 at a
/// crossing.
#ifndef HALF_CYCLES_H
#define HALF_CYCLES_H

#include "fixq.h"

typedef struct {
    int32_t last_um_s;   ///< velocity
    uint32_t since_q8;   ///< ticks since it last crossed zero
    uint32_t before_q8;  ///< length of the half cycle that ended there ..
    uint32_t earlier_q8; ///< .. and of the one before that
    int32_t peak_um_s;   ///< largest magnitude since
    bool is_up;          ///< the velocity is positive
    bool is_rough;       ///< the sign has changed, but not yet by enough
    uint8_t alike;       ///< half cycles in a row that resembled the two before them, saturating
    uint32_t rough_q8;   ///< since_q8 where it did
} half_cycles_t;

/// What three half cycles say, as of now.
typedef struct {
    uint32_t period_q8; ///< of a cycle
    uint32_t since_q8;  ///< the velocity crossed zero
    bool is_up;         ///< and is positive since
    uint8_t alike;      ///< 1 or more: so many half cycles in a row have said so
} half_cycles_tone_t;

/// Forgets what was before.
void half_cycles_reset(half_cycles_t *self);

/// Ticks that went by without a call: half cycles last on.
void half_cycles_skip(half_cycles_t *self, uint32_t ticks);

/// One tick. Returns true iff a half cycle ended in it that resembles the two before it, within an
/// eighth; *tone is then written.
bool half_cycles_step(half_cycles_t *self, int32_t velocity_um_s, half_cycles_tone_t *tone);

/// Turns a tick. A 64-bit division, so for where it is wanted.
uint32_t half_cycles_step_turn(const half_cycles_tone_t *tone);

/// Phase of the acceleration, amp x cos(phase), with turns a tick.
uint32_t half_cycles_phase_turn(const half_cycles_tone_t *tone, uint32_t step_turn);

#endif
