/// Random numbers, parameters and vibrations in integers. They belong to the golden traces alone:
/// neither the firmware nor its other tests can change what the traces are made of.
#ifndef DRAW_H
#define DRAW_H

#include "quiesce.h"

/// Parameters of the first recording, in their order on the wire, which is only ever appended to:
/// one that is new changes no stream.
#define DRAW_PARAMS 44u

/// 0 .. count - 1; 0 for a count of 0. Advances *seed.
uint32_t draw_below(uint32_t *seed, uint32_t count);

/// low .. high, both included.
int32_t draw_between(uint32_t *seed, int32_t low, int32_t high);

/// True one time in count.
bool draw_one_in(uint32_t *seed, uint32_t count);

/// Amplitude x sin(phase), phase in turns Q32, to 0.1 % of the amplitude, which is at most 2^24.
int32_t draw_sine(int32_t amplitude, uint32_t phase_turn);

/// Sets some parameters, each anywhere in its range or near its default.
void draw_settings(uint32_t *seed, uint32_t count, quiesce_params_t *params);

/// A stretch of two tones, noise and an offset; drawn anew when it is over.
typedef struct {
    uint32_t left_ticks;
    uint32_t phase_turn[2];
    uint32_t step_turn[2];
    int32_t amplitude[2];
    int32_t noise;
    int32_t offset;
} vibration_t;

/// Any: 0.5 to 52 Hz, nearly nothing to full scale.
void draw_stretch(uint32_t *seed, int32_t rate_Hz, vibration_t *out);

/// One that the tracker locks on: 5 to 21 Hz, strong.
void draw_steady(uint32_t *seed, int32_t rate_Hz, vibration_t *out);

/// The next sample, counts.
int32_t draw_sample(uint32_t *seed, vibration_t *vibration);

#endif
