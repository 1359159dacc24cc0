/// RMS velocity of a band, by integration in the spectrum: each Hann power counts with 1/(2 pi f)^2
/// of its bin. Band: the bins whose middles lie within band_low .. band_high, at most 52 Hz.
/// (Machine standards' "vibration severity", 10 .. 1000 Hz, needs a faster tick: this is not it.)
///
/// A tone spreads over four bins, each weighted with its own frequency: high by 10 % at 3 bins, 2 %
/// at 6, 1 % at 10. Formats: powers (um/s2)^2, 64 bit; result um/s, floor. Bounded, about 12
/// instructions a bin and 200 at the end.
#ifndef VELOCITY_H
#define VELOCITY_H

#include "fixq.h"

typedef struct {
    int32_t band_low_mHz;
    int32_t band_high_mHz;
    uint32_t points_log2;
    uint32_t first_bin; ///< of the band
    uint32_t end_bin;
    int32_t rms_um_s; ///< of the last finished spectrum
    uint64_t sum;     ///< of power / bin^2
} velocity_t;

void velocity_init(velocity_t *self, int32_t band_low_mHz, int32_t band_high_mHz);

/// A new spectrum of 2^points_log2 samples at 250 Hz is about to be read.
void velocity_start(velocity_t *self, uint32_t points_log2);

/// Reads powers first .. end-1 (first >= 1).
void velocity_read(velocity_t *self, const uint64_t *power, uint32_t first, uint32_t end);

/// All powers have been read: updates rms_um_s.
void velocity_end(velocity_t *self);

#endif
