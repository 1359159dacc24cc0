/// Dominant frequency from the sliding spectrum: which peaks are real, and which one matters.
///
/// A peak counts when it stands snr above the noise floor (mean of the log powers), above 1/20 of
/// the strongest peak (leakage) and above min_accel. Of these the one with the largest
/// displacement, amplitude / frequency^2, is the dominant one: the third harmonic of a sticking
/// damper can exceed its fundamental in acceleration, not in displacement. Frequency between bins
/// from the two largest magnitudes of the Hann main lobe: d = (2r - 1)/(r + 1).
///
/// Valid: a counted peak inside the band, a window full of good samples, and STEADY_ROUNDS rounds
/// in a row (32 ms) within 1/32 of each other. Estimates describe the middle of the window: they
/// lag by half of 1.024 s plus the decimator's delay (0.527 s at 1 kHz). Formats: powers
/// (um/s2)^2 in 64 bit; frequency 1 uHz, resolved to about 40 uHz by the 16-bit roots. Bounded;
/// about 30 instructions a bin and 1500 at the end of a round.
#ifndef TRACKER_H
#define TRACKER_H

#include "fixq.h"

#define TRACKER_PEAKS 3      ///< reported
#define TRACKER_CANDIDATES 6 ///< kept while a round is read
#define TRACKER_FIRST_BIN 1
#define TRACKER_LAST_BIN 52
#define TRACKER_STEADY_ROUNDS 8

typedef struct {
    int32_t band_low_mHz;
    int32_t band_high_mHz;
    int32_t min_accel_um_s2;
    int32_t snr_dB;
    uint32_t rate_uHz;      ///< sample rate of the window; bin k lies at k rate / 2^points_log2
    uint32_t points_log2;   ///< samples of the window, as a power of two
    uint32_t window_rounds; ///< rounds that fill the window
} tracker_cfg_t;

typedef struct {
    int32_t freq_uHz;
    int32_t amp_um_s2;
} tracker_peak_t;

typedef struct {
    tracker_cfg_t cfg;
    uint64_t min_power;
    uint32_t snr_log2_q8;
    uint32_t log2_sum_q8;                   ///< of the round being read
    uint32_t candidate[TRACKER_CANDIDATES]; ///< bins of local maxima, strongest first
    uint32_t candidates;
    uint32_t good_rounds;   ///< since the window last held a bad stretch, saturating
    uint32_t steady_rounds; ///< rounds whose dominant frequency agreed with the one before
    int32_t round_freq_uHz; ///< of the last round, 0 where it had none
    bool is_valid;
    uint32_t age_ticks;
    tracker_peak_t dominant;            ///< last valid one
    tracker_peak_t peak[TRACKER_PEAKS]; ///< counted peaks of the last round, strongest first
} tracker_t;

void tracker_init(tracker_t *self, const tracker_cfg_t *cfg);

/// Reads powers first .. end-1 (rising; a round starts at TRACKER_FIRST_BIN).
void tracker_read(tracker_t *self, const uint64_t *power, uint32_t first, uint32_t end);

/// Ends a round: all powers belong to one window. The previous slices must have been read.
void tracker_end_round(tracker_t *self, const uint64_t *power);

/// Every tick, after reading: ages the estimate. is_input_good = false: the sensor is lost; the
/// estimate is invalid until the window has been filled anew.
void tracker_tick(tracker_t *self, bool is_input_good);

#endif
