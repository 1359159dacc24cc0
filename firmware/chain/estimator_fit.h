/// The estimator by sliding DFTs and least squares: decimate, spectrum, tone_fit, tracker, velocity
/// and predictor, wired.
///
/// A job runs in the background, a bounded slice a tick: take in the longest window that holds only
/// samples since the last change, search its spectrum, fit, decide, publish; then the next one. In
/// between the components run on at every tick, and every sample is checked against them: a change
/// makes the estimate invalid at once and starts the windows anew at the moment when it began
/// (unless the samples fit again after a small burst). Windows shorter than the longest (which
/// is 1.024 s; 0.128, 0.256 and 0.512 s) are used only after a vibration of one component: they
/// could not tell several apart.
#ifndef ESTIMATOR_FIT_H
#define ESTIMATOR_FIT_H

#include "estimate.h"
#include "spectrum.h"
#include "tone_fit.h"

typedef enum {
    ESTIMATOR_FIT_WAIT,   ///< for samples
    ESTIMATOR_FIT_SEARCH, ///< for the spectrum's powers
    ESTIMATOR_FIT_READ,
    ESTIMATOR_FIT_CHOOSE,
    ESTIMATOR_FIT_GATHER,
    ESTIMATOR_FIT_FIT,
    ESTIMATOR_FIT_DECIDE,
    ESTIMATOR_FIT_PUBLISH,
    ESTIMATOR_FIT_SPREAD, ///< all powers once more, of what has no steady component
} estimator_fit_stage_t;

typedef struct {
    estimate_t known;
    uint32_t slice_powers;  ///< to read a tick
    uint32_t slice_pairs;   ///< of work a tick
    uint32_t longest_level; ///< longest window in use
    uint32_t hop_ticks;
    int32_t clean_samples;     ///< that hold nothing from before the last change
    uint32_t sample_age_ticks; ///< of the newest sample
    uint32_t job_age_ticks;    ///< of the newest sample in the job's window
    uint32_t job_ticks;        ///< since the job began, saturating
    uint32_t spread_ticks;     ///< from a reading of a window's spread to the job's begin, modulo
    uint32_t spread_hop_ticks; ///< least time between two of them
    uint32_t level;            ///< the job's window
    uint32_t published_level;  ///< window of the last published fit
    bool is_suspended;         ///< a change or a burst: which is not known yet
    uint32_t suspended_ticks;
    uint32_t suspend_most_ticks;
    uint32_t most_level; ///< longest window that the vibration has not contradicted lately
    uint32_t calm_ticks; ///< since it last did
    uint32_t calm_enough_ticks;
    bool is_pure; ///< the longest window last held one component only: shorter ones may be trusted
    estimator_fit_stage_t stage;
    uint32_t next_power;            ///< to be read
    uint32_t fits;                  ///< to the job's window so far
    bool has_drift;                 ///< in the job's window
    bool is_drifting;               ///< so did the last published one of the longest window
    bool is_drift_futile;           ///< it left as much unexplained as without
    int32_t residual_without_um_s2; ///< of the fit before a drift was tried; 0: none is tried
    tone_fit_t fit;
    spectrum_t spectrum;
} estimator_fit_t;

void estimator_fit_init(estimator_fit_t *self, const estimator_cfg_t *cfg);

/// One tick.
void estimator_fit_step(estimator_fit_t *self, const estimator_in_t *in);

#endif
