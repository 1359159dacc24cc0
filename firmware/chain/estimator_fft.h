/// The estimator by FFT: decimate to 1 kHz, fft, tracker, velocity and predictor, wired.
///
/// Every 50 ms the last 1.024 s are transformed under a Hann window: 1024 samples at ticks of 1 kHz
/// and more, 512 at 500 Hz. (The pipeline of the squeeze-mode paper: 1024-point FFT, hop 50.) Its
/// bins are those of the longest window of estimator_fit.h; the same tracker finds the peaks, with
/// the same bounds, and names the dominant one.
///
/// Frequency: the two largest magnitudes m0 >= m1 of the main lobe, d = (2 m1 - m0) / (m1 + m0)
/// bins (T. Grandke, IEEE Trans. Instrum. Meas. 32(2), 1983), in steps of 30 uHz. Amplitude: the
/// bin's, over the window's response d bins off its middle. Phase: the bin's, exact at the middle
/// of the window. What remains of the image at negative frequency moves the frequency by
/// up to 0.075 / f^3 bins, f in bins: that is part of the expected deviation. Below two bins, 1.95
/// Hz, it is never valid.
///
/// Estimates are published at every hop. They are valid where the tracker says so and the window
/// holds nothing from before the last contradiction of the predictor's watch: 1.1 s after a change.
///
/// Work: every tick gets the same credit, a hop's instructions over its ticks, and works off that
/// much of the transform's items and of the steps after it.
#ifndef ESTIMATOR_FFT_H
#define ESTIMATOR_FFT_H

#include "estimate.h"
#include "fft.h"

#define ESTIMATOR_FFT_HOP_ms 50

typedef enum {
    ESTIMATOR_FFT_WAIT, ///< for the next hop
    ESTIMATOR_FFT_TRANSFORM,
    ESTIMATOR_FFT_READ,
    ESTIMATOR_FFT_CHOOSE,
    ESTIMATOR_FFT_REFINE,
    ESTIMATOR_FFT_DECIDE,
    ESTIMATOR_FFT_PUBLISH,
} estimator_fft_stage_t;

typedef struct {
    estimate_t known;
    estimator_fft_stage_t stage;
    int32_t credit; ///< for work, instructions
    int32_t credit_a_tick;
    uint32_t hop_ticks;
    uint32_t job_ticks;        ///< since the transform at work began, saturating
    int32_t full_samples;      ///< since the sensor was last lost
    int32_t clean_samples;     ///< since the last contradiction
    uint32_t sample_age_ticks; ///< of the newest sample
    uint32_t window_age_ticks; ///< of the newest sample of the window at work
    bool is_clean;             ///< nothing in that window is from before the last contradiction
    bool is_published_clean;   ///< nor in the one of the last estimate
    uint32_t next_power;       ///< to be read
    uint32_t refined;          ///< starts
    uint64_t energy;           ///< sum of the powers / 64
    uint64_t rest;             ///< of that, outside of the tones' lobes
    uint32_t rest_bins;        ///< that it is in
    int32_t constant_um_s2;    ///< mean of the window without the tones' parts
    int32_t residual_um_s2;    ///< that the tones leave, as noise at 250 Hz
    tracker_tone_t tone[TRACKER_TONES];
    uint64_t power[FFT_LAST_BIN + 1]; ///< (um/s2)^2, from index 1
    fft_t fft;
} estimator_fft_t;

void estimator_fft_init(estimator_fft_t *self, const estimator_cfg_t *cfg);

/// One tick.
void estimator_fft_step(estimator_fft_t *self, const estimator_in_t *in);

#endif
