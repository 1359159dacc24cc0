/// Where a motion without a steady component lies, and how broad it is: moments of its spectra, in
/// the band of velocity.h, forgotten over some seconds.
///
/// The power of the acceleration a, each bin over k^2 that of the velocity v, over k^4 that of the
/// displacement x: two mean frequencies, v / x and a / v, in that order. Their ratio is 1 for a
/// tone (the irregularity factor of the displacement). What lies above twice the largest mean
/// frequency is left out of v and x: such a motion is broad all the same. Formats: powers
/// (um/s2)^2, means of sums of power / 256, 64 bit. Bounded, about 45 instructions a bin, 10 one of
/// acceleration alone, and 200 at the end.
#ifndef SPREAD_H
#define SPREAD_H

#include "fixq.h"

#define SPREAD_POINTS_LOG2 8u ///< of the spectra that it reads, 250 Hz: 1.024 s

typedef struct {
    int32_t low_mHz;     ///< where both mean frequencies are to be, 0 .. 60000 mHz
    int32_t high_mHz;    ///< 0: nothing is ever read
    int32_t least_um_s2; ///< RMS acceleration, at least
} spread_cfg_t;

typedef struct {
    uint64_t mean[3]; ///< of sums of power / k^0, k^2, k^4
    uint32_t least_um_s2;
    uint32_t low_k2_q8; ///< squares of frequencies in bins
    uint32_t high_k2_q8;
    uint8_t far_bin; ///< from here on read as acceleration alone
    uint8_t spectra; ///< in the mean, saturating
    bool is_narrow;  ///< a narrow band in low .. high
} spread_t;

void spread_init(spread_t *self, const spread_cfg_t *cfg);

static inline bool spread_is_wanted(const spread_t *self) {
    return self->high_k2_q8 != 0;
}

/// Nothing is known.
void spread_forget(spread_t *self);

/// Takes a spectrum in, powers first_bin .. end_bin - 1 (velocity.h knows them), at most 64, each
/// below 2^61.
void spread_take(spread_t *self, const uint64_t *power, uint32_t first_bin, uint32_t end_bin);

#endif
