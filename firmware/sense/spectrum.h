/// Sliding spectra of the last 32, 64, 128 and 256 samples at 250 Hz (0.128 .. 1.024 s), 0 .. 52
/// Hz.
///
/// Modulated sliding DFTs: each new sample enters a bin and the one that it pushes out of the
/// window leaves, with the same table entry, so that the bins are exact integers and never drift. A
/// constant leaves no trace in them at all. The bins are worked off in slices, one a tick, so that
/// no tick has a spike. On request a round also forms the powers of one window under the Hann
/// window, whose three coefficients are applied to the bins.
///
/// Scaling: samples um/s2, |x| < 2^29; table Q25; bins 64 bit, below 2^8 x 2^29 x 2^25 = 2^62. A
/// tone of amplitude A makes |bin| = A x points / 2 x 2^25; powers are A^2 where a bin's middle
/// meets the tone, 64 bit, A in steps of 256 / points um/s2. Bounded; about 17 instructions a bin
/// and 50 more for a power. Source of the sliding form: K. Duda, IEEE Signal Processing Magazine
/// 27(6), 2010 (equations only).
#ifndef SPECTRUM_H
#define SPECTRUM_H

#include "fixq.h"

#define SPECTRUM_RATE_Hz 250
#define SPECTRUM_LEVELS 4 ///< window lengths
#define SPECTRUM_FIRST_LOG2 5
#define SPECTRUM_POINTS_LOG2(level) (SPECTRUM_FIRST_LOG2 + (level))
#define SPECTRUM_POINTS(level) (1u << SPECTRUM_POINTS_LOG2(level))
#define SPECTRUM_LONGEST (SPECTRUM_LEVELS - 1)
#define SPECTRUM_RING 512      ///< samples kept: twice the longest window
#define SPECTRUM_MAX_POWERS 53 ///< powers 1 .. 52 of the longest window
#define SPECTRUM_BINS (8 + 15 + 28 + 53)

typedef struct {
    int64_t re;
    int64_t im;
} spectrum_bin_t;

typedef struct {
    int32_t sample[SPECTRUM_RING];       ///< at 250 Hz
    spectrum_bin_t bin[SPECTRUM_BINS];   ///< bins 1 .. of each window, shortest window first
    int64_t sum[SPECTRUM_LEVELS];        ///< of each window's samples
    int32_t difference[SPECTRUM_LEVELS]; ///< newest sample minus the one that leaves
    uint64_t power[SPECTRUM_MAX_POWERS]; ///< (um/s2)^2 of the last requested round, from index 1
    uint32_t newest;                     ///< ring index of the newest sample
    uint32_t slices_log2;                ///< of a round
    uint32_t next_slice;                 ///< all done: the round is finished
    uint32_t power_level;   ///< window whose powers are being formed; SPECTRUM_LEVELS: none
    uint32_t power_round;   ///< of the rounds that share them
    uint32_t wanted_level;  ///< window to start with in the next round
    bool has_powers;        ///< power[] is complete
    int32_t constant_um_s2; ///< that bin 0 is to be without
} spectrum_t;

/// slices_log2: ticks a sample, as a power of two, 1 .. 4.
void spectrum_init(spectrum_t *self, uint32_t slices_log2);

/// The next rounds shall form the powers of a window, less a constant part of the samples;
/// has_powers tells when they have. (Those of the longest window come from two rounds, alternating
/// bins.)
void spectrum_want_powers(spectrum_t *self, uint32_t level, int32_t constant_um_s2);

/// A new sample, |accel_um_s2| < 2^29; starts a round.
void spectrum_start_round(spectrum_t *self, int32_t accel_um_s2);

/// One slice of the round. All of it must be worked off before the next sample.
void spectrum_slice(spectrum_t *self);

/// Last power of a window (they start at 1).
uint32_t spectrum_last_power(uint32_t level);

/// Mean of a window's samples, um/s2, floor.
int32_t spectrum_mean_um_s2(const spectrum_t *self, uint32_t level);

#endif
