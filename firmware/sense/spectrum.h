/// Sliding spectrum of the last 1.024 s, 0 .. 51.8 Hz in bins of 0.977 Hz, fresh every 4 ms.
///
/// Half-band filters bring every tick rate down to 250 Hz (window: 256 samples). A modulated
/// sliding DFT adds the new sample and takes the old one away with the same table entry, so that
/// the bins are exact integers and never drift. The Hann window is applied to the bins (its three
/// coefficients), not to the samples. The bins are worked off in slices, one a tick, so that no
/// tick has a spike.
///
/// Scaling: samples um/s2, limited to 2^29; table Q25; bins 64 bit, at most 2^8 x 2^29 x 2^25 =
/// 2^62. A tone of amplitude A makes |bin| = A x 2^7 x 2^25, so that the high word reads A in um/s2
/// (floor); power = A^2, 64 bit. Decimator: 11 taps Q16, stop band -62 dB, pass band (0 .. 50 Hz)
/// flat to 0.007 dB, group delay 5 samples of each stage's input: 15 ms at 1 kHz. Bounded; about 55
/// instructions a bin. Source of the sliding form: K. Duda, IEEE Signal Processing Magazine 27(6),
/// 2010 (equations only).
#ifndef SPECTRUM_H
#define SPECTRUM_H

#include "fixq.h"

#define SPECTRUM_POINTS_LOG2 8
#define SPECTRUM_POINTS (1 << SPECTRUM_POINTS_LOG2)
#define SPECTRUM_RATE_Hz 250
#define SPECTRUM_BINS 54 ///< sliding bins 0 .. 53; powers exist for 1 .. 52
#define SPECTRUM_MAX_STAGES 4
#define SPECTRUM_TAPS 11

typedef struct {
    int32_t line[SPECTRUM_TAPS - 1]; ///< last input samples, newest first
    bool is_odd;
} spectrum_stage_t;

typedef struct {
    int64_t re;
    int64_t im;
} spectrum_bin_t;

/// Angle of the window's first sample.
typedef struct {
    int32_t cos_q31;
    int32_t sin_q31;
} spectrum_turn_t;

typedef struct {
    int32_t sample[SPECTRUM_POINTS]; ///< ring at 250 Hz
    spectrum_bin_t bin[SPECTRUM_BINS];
    uint64_t power[SPECTRUM_BINS]; ///< amplitude squared under the window, (um/s2)^2; 1 .. 52 used
    spectrum_stage_t stage[SPECTRUM_MAX_STAGES];
    uint32_t stages;
    uint32_t newest; ///< ring index of the newest sample
    spectrum_turn_t window_turn;
    int32_t difference;  ///< newest minus the sample that it replaced
    uint32_t next_bin;   ///< first bin of the next slice; SPECTRUM_BINS: the round is finished
    uint32_t slice_bins; ///< bins a tick
} spectrum_t;

/// What one tick has brought up to date: powers first .. end-1.
typedef struct {
    uint32_t first;
    uint32_t end;
    bool is_round_end; ///< powers 1 .. 52 now belong to the same window
} spectrum_span_t;

/// tick_rate_Hz: 500, 1000, 2000 or 4000.
void spectrum_init(spectrum_t *self, uint32_t tick_rate_Hz);

/// One sample, |accel_um_s2| <= 5 x 10^8.
spectrum_span_t spectrum_step(spectrum_t *self, int32_t accel_um_s2);

#endif
