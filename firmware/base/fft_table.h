/// What a transform of up to 1024 points reads.
#ifndef FFT_TABLE_H
#define FFT_TABLE_H

#include <stdint.h>

#define FFT_TABLE_POINTS 1024

/// cos(2 pi i / 1024) x (2^31 - 1), rounded to nearest. sin is fft_cosine_q31[(i - 256) & 1023].
extern const int32_t fft_cosine_q31[FFT_TABLE_POINTS];

/// Periodic Hann window (1 - cos(2 pi i / 1024)) / 2 x 2^29 up to its middle, i = 0 .. 512;
/// symmetric.
extern const int32_t fft_hann_q29[FFT_TABLE_POINTS / 2 + 1];

#endif
