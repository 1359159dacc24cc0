/// Displacement of the dominant component and its third harmonic, from their accelerations:
/// x = - sum of amp / (2 pi f)^2 cos(phase), and half peak-to-peak over a cycle.
///
/// Formats: nm, saturated to 31 bits; phases in turns Q32. The phase error is the estimator's own.
/// Bounded, about 70 instructions a tick.
#ifndef DISPLACEMENT_H
#define DISPLACEMENT_H

#include "harmonics.h"

typedef struct {
    harmonic_span_t span;         ///< acceleration's sign: the displacement's is opposite
    int32_t half_peak_to_peak_nm; ///< of the last finished search
} displacement_t;

/// At rest.
void displacement_reset(displacement_t *self);

/// New components, amplitudes >= 0; phase_turn: of the third harmonic less three times that of the
/// fundamental.
void displacement_load(displacement_t *self, int32_t fundamental_nm, int32_t third_nm,
                       uint32_t phase_turn);

/// One tick: goes on with the search; returns the displacement at this phase of the fundamental,
/// nm.
int32_t displacement_step(displacement_t *self, uint32_t phase_turn);

#endif
