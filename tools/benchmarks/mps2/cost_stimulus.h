/// What the sensing chain is fed with while its cost is counted: every kind of vibration and of bad
/// input that it can meet, integer only, the same on every run.
///
/// One round of about 40 s, then the next one with other frequencies: sines over the band (each
/// start is a phase-continuous step of the frequency), sweeps, two and three tones, a fundamental
/// with its harmonics, slow drift, free decay, noise alone, silence; samples that saturate, drop
/// out (one at a time, and for long enough to be a fault), stick, are out of range or are single
/// glitches; lost ticks. Noise is 20 dB below the strongest sine (SNR = A^2/(2 sigma^2)).
#ifndef COST_STIMULUS_H
#define COST_STIMULUS_H

#include "quiesce.h"

#define COST_STIMULUS_TONES 3u

typedef struct {
    uint32_t phase;     ///< of the turn, Q32
    uint32_t increment; ///< of the phase a tick
    int32_t amplitude_counts;
} cost_tone_t;

typedef struct {
    uint32_t tick_rate_Hz;
    uint32_t tick;
    uint32_t segment; ///< index in the round
    uint32_t segment_ticks;
    uint32_t tick_in_segment;
    uint32_t seed;
    int32_t held_counts; ///< of a stuck sensor
    cost_tone_t tones[COST_STIMULUS_TONES];
} cost_stimulus_t;

/// tick_rate_Hz: 500 .. 4000.
void cost_stimulus_init(cost_stimulus_t *self, uint32_t tick_rate_Hz);

/// The next tick's input.
void cost_stimulus_next(cost_stimulus_t *self, quiesce_in_t *in);

#endif
