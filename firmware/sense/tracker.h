/// Which components of a spectrum are real, which one matters, and when it can be trusted.
///
/// search: a local maximum of the Hann powers times frequency^2 counts when it stands above
/// min_accel and 1/20 of the strongest (leakage), and in the longest window also snr above the
/// noise floor (mean of the log powers; the shorter windows have too few bins to know it). Start
/// frequencies for the fit come from the two largest magnitudes of the main lobe, d = (2r - 1)/(r +
/// 1), or from the last fit where that found the component already.
///
/// decide: of the fitted components inside the band the one that holds nine sixteenths of their
/// energy (half of it, where it was the dominant one before) is the dominant one, else the one with
/// the largest displacement, amplitude / frequency^2; but where that is the third harmonic of
/// another one, a sticking damper's, it is the other one. It is trusted when the fit has converged,
/// expects a small error, spans enough cycles and, in a short window, leaves next to nothing
/// unexplained (what a short window cannot resolve must not hide in it).
///
/// Formats: powers (um/s2)^2 in 64 bit; frequencies in turns a sample at 250 Hz, Q32 (58 nHz).
/// Bounded: 20 instructions a power, about 600 for search's end and decide.
#ifndef TRACKER_H
#define TRACKER_H

#include "fixq.h"

#define TRACKER_TONES 3 ///< fitted and reported
/// A fit that moves a frequency no further has converged, radians over half a window: 0.04 bins, of
/// which 5 x 10^-4 bins are left at most (0.005 below two cycles a window).
#define TRACKER_CONVERGED_Q29 (1 << 26)
#define TRACKER_CANDIDATES 6 ///< kept while a spectrum is read

typedef struct {
    int32_t band_low_mHz;
    int32_t band_high_mHz;
    int32_t min_accel_um_s2;
    int32_t snr_dB;
} tracker_cfg_t;

/// A window's length and how well a fit explains it.
typedef struct {
    uint32_t points_log2;
    uint32_t last_power; ///< powers 1 .. last_power exist
    bool is_longest;     ///< long enough for several components and a noise floor
} tracker_window_t;

/// A component as fitted, at the middle of its window.
typedef struct {
    uint32_t turn; ///< frequency, turns a sample Q32
    uint32_t phase_turn;
    uint32_t sigma_turn;
    int32_t shift_q29; ///< how far the fit moved it, radians over half a window
    int32_t amp_um_s2;
    int32_t freq_uHz;
} tracker_tone_t;

/// Where the fit shall start.
typedef struct {
    uint32_t turn; ///< turns a sample Q32
    uint32_t amp;  ///< um/s2, roughly
} tracker_start_t;

typedef struct {
    tracker_cfg_t cfg;
    uint64_t min_power;
    uint32_t snr_log2_q8;
    tracker_window_t window;
    uint32_t log2_sum_q8[2];                ///< of the powers read so far, lower and upper half
    uint32_t candidate[TRACKER_CANDIDATES]; ///< bins of local maxima, strongest first
    uint32_t candidates;
    uint32_t next;                             ///< of them, to be looked at
    uint64_t height;                           ///< of the newest power, rising weight
    tracker_start_t start[TRACKER_CANDIDATES]; ///< dominant one first in the longest window
    uint32_t starts;                           ///< at most TRACKER_TONES in the end
    uint32_t strongest_um_s2;                  ///< amplitude of the strongest of them
    tracker_tone_t tone[TRACKER_TONES]; ///< of the last fit; in the band first, dominant one first
    uint32_t tones;
    uint32_t in_band; ///< of them
    uint32_t hints;   ///< tones that are still there as hints after a reset
    uint32_t misses;  ///< fits in a row that do not
    bool is_rising;   ///< towards the newest power
    bool has_drift;   ///< something slower than the window can resolve is there
    bool is_valid;    ///< the last fits qualify
    bool is_clear;    ///< and leave so little unexplained that a change would be seen soon
} tracker_t;

void tracker_init(tracker_t *self, const tracker_cfg_t *cfg);

/// Forgets everything: the vibration has changed or the sensor was lost.
void tracker_reset(tracker_t *self);

/// A new spectrum is about to be read.
void tracker_start_search(tracker_t *self, const tracker_window_t *window);

/// Reads powers first .. end-1 (rising from 1).
void tracker_read(tracker_t *self, const uint64_t *power, uint32_t first, uint32_t end);

/// All powers have been read: looks at the candidates up to the next one that
/// counts. Returns true iff start, starts and
/// has_drift are complete.
bool tracker_choose(tracker_t *self, const uint64_t *power);

/// Whether a frequency is too low to be told from a drift in the window: below 7/8 of a cycle.
bool tracker_is_drift(const tracker_t *self, uint32_t turn);

/// Whether a fit of the longest window leaves 1.5 times what the spectrum's noise floor accounts
/// for (standard deviations): something slow may hide below a component.
bool tracker_is_missing_something(const tracker_t *self, int32_t residual_um_s2);

/// Takes a fit over (tones as fitted, any order, count 0 .. TRACKER_TONES), what it leaves
/// (standard deviation) and the share of the energy that it explains. Returns true iff self->tone
/// qualifies for publishing.
bool tracker_decide(tracker_t *self, const tracker_tone_t *tones, uint32_t count,
                    int32_t residual_um_s2, uint32_t explained_q16);

/// Frequency in uHz of turns a sample at 250 Hz, to nearest.
static inline int32_t tracker_freq_uHz(uint32_t turn) {
    return (int32_t)(((uint64_t)turn * 250000000u + (UINT64_C(1) << 31)) >> 32);
}

#endif
