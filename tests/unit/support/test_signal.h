// Integer test signals, the same bits on every target.
#ifndef TEST_SIGNAL_H
#define TEST_SIGNAL_H

#include <stdint.h>

/// Amplitude x sin(2 pi f t) at t = tick / rate, by linear interpolation of a 256-point table
/// (error below 1e-4 of the amplitude). amplitude: any int32; freq_mHz below rate x 500.
int32_t signal_sine(int32_t amplitude, uint32_t freq_mHz, uint32_t tick, uint32_t rate_Hz);

/// Amplitude x cos(phase), phase in turns Q32; rounded to nearest, and as exact as sincos_q30.
int32_t signal_cosine(int32_t amplitude, uint32_t phase_turn);

/// Uniform noise in -span .. span from a 32-bit linear congruential generator; advances *seed.
int32_t signal_noise(uint32_t *seed, int32_t span);

/// Nearly normal noise of standard deviation sigma, within 6 sigma; advances *seed.
int32_t signal_normal(uint32_t *seed, int32_t sigma);

#endif
