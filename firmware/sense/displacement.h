/// Displacement of the dominant component and its third harmonic, from their accelerations:
/// x = - sum of amp / (2 pi f)^2 cos(phase). Half peak-to-peak over a cycle is searched at 32
/// points a half cycle, two a tick (both are odd about half a cycle); between points the peak is at
/// most 0.5 % of the fundamental and 1.1 % of the third harmonic higher.
///
/// Formats: nm, saturated to 31 bits; phases in turns Q32. The phase error is the estimator's own.
/// Bounded, about 70 instructions a tick.
#ifndef DISPLACEMENT_H
#define DISPLACEMENT_H

#include "trig.h"

typedef struct {
    int32_t fundamental_nm; ///< amplitudes
    int32_t third_nm;
    uint32_t third_phase_turn;    ///< where the third harmonic is when the fundamental is at 0
    uint32_t point;               ///< of the search, DISPLACEMENT_POINTS: finished
    int32_t peak_nm;              ///< largest magnitude of the search so far
    int32_t half_peak_to_peak_nm; ///< of the last finished search
} displacement_t;

#define DISPLACEMENT_POINTS 32

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
