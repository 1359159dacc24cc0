/// What vibrates, and how: decimate, spectrum, tone_fit, tracker, velocity and predictor, wired.
///
/// A job runs in the background, a bounded slice a tick: take in the longest window that holds only
/// samples since the last change, search its spectrum, fit, decide, publish; then the next one. In
/// between the components run on at every tick, and every sample is checked against them: a change
/// makes the estimate invalid at once and starts the windows anew at the moment when it began
/// (unless the samples fit again after a small burst). Windows shorter than the longest (which
/// is 1.024 s; 0.128, 0.256 and 0.512 s) are used only after a vibration of one component: they
/// could not tell several apart.
#ifndef ESTIMATOR_H
#define ESTIMATOR_H

#include "decimate.h"
#include "predictor.h"
#include "spectrum.h"
#include "tone_fit.h"
#include "tracker.h"
#include "velocity.h"

#define ESTIMATOR_TONES PREDICTOR_TONES

typedef struct {
    uint32_t tick_rate_Hz;
    uint32_t longest_ms; ///< 128, 256, 512 or 1024
    uint32_t hop_ms;     ///< least time from one job's start to the next one's
    tracker_cfg_t tracker;
} estimator_cfg_t;

typedef struct {
    int32_t accel_um_s2; ///< before DC removal, |x| < 2^29
    bool is_good;        ///< else accel_um_s2 is a held value
    bool is_lost;        ///< the sensor is lost, or ticks are: start anew
} estimator_in_t;

/// A published component. Its phase is the predictor's.
typedef struct {
    int32_t freq_uHz;
    int32_t amp_um_s2;
    int32_t displacement_nm; ///< amplitude; saturates
} estimator_tone_t;

typedef enum {
    ESTIMATOR_WAIT,   ///< for samples
    ESTIMATOR_SEARCH, ///< for the spectrum's powers
    ESTIMATOR_READ,
    ESTIMATOR_CHOOSE,
    ESTIMATOR_GATHER,
    ESTIMATOR_FIT,
    ESTIMATOR_DECIDE,
    ESTIMATOR_PUBLISH,
} estimator_stage_t;

typedef struct {
    decimate_t decimate;
    spectrum_t spectrum;
    tone_fit_t fit;
    tracker_t tracker;
    predictor_t predictor;
    velocity_t velocity;
    uint32_t stages;        ///< a sample every 2^stages ticks
    uint32_t slice_powers;  ///< to read a tick
    uint32_t slice_pairs;   ///< of work a tick
    uint32_t longest_level; ///< longest window in use
    uint32_t hop_ticks;
    int32_t clean_samples;     ///< that hold nothing from before the last change
    uint32_t sample_age_ticks; ///< of the newest sample
    uint32_t job_age_ticks;    ///< of the newest sample in the job's window
    uint32_t job_ticks;        ///< since the job began, saturating
    uint32_t level;            ///< the job's window
    uint32_t published_level;  ///< window of the last published fit
    uint32_t steady_turn;      ///< where tone[0] has stayed ..
    uint32_t steady_amp_um_s2;
    uint32_t steady_ticks; ///< .. for so long, not contradicted by a sample
    uint32_t trust_ticks;  ///< of them that make up for noise
    bool is_suspended;     ///< a change or a burst: which is not known yet
    uint32_t suspended_ticks;
    uint32_t suspend_most_ticks;
    uint32_t most_level; ///< longest window that the vibration has not contradicted lately
    uint32_t calm_ticks; ///< since it last did
    uint32_t calm_enough_ticks;
    bool is_pure; ///< the longest window last held one component only: shorter ones may be trusted
    estimator_stage_t stage;
    uint32_t next_power;            ///< to be read
    uint32_t fits;                  ///< to the job's window so far
    bool has_drift;                 ///< in the job's window
    bool is_drifting;               ///< so did the last published one of the longest window
    bool is_drift_futile;           ///< it left as much unexplained as without
    int32_t residual_without_um_s2; ///< of the fit before a drift was tried; 0: none is tried
    estimator_tone_t tone[ESTIMATOR_TONES]; ///< last published; dominant one first, 0 Hz: none
    int32_t sigma_uHz;                      ///< expected of tone[0].freq_uHz
    uint32_t window_ms;                     ///< that they come from
    bool has_published;                     ///< in this tick
    uint32_t age_ticks;                     ///< since tone[0] was last valid, saturating
} estimator_t;

void estimator_init(estimator_t *self, const estimator_cfg_t *cfg);

/// One tick.
void estimator_step(estimator_t *self, const estimator_in_t *in);

/// Whether tone[0] can be trusted now: at once where a change would be seen soon, else after the
/// samples of another one and a half windows have not contradicted it and the frequency has stayed
/// within 3
/// %.
static inline bool estimator_is_valid(const estimator_t *self) {
    return self->tracker.is_valid && self->predictor.is_armed && !self->is_suspended &&
           (self->tracker.is_clear || self->steady_ticks >= self->trust_ticks);
}

/// Phase of a published component at this tick, in turns Q32: acceleration = amp cos(phase).
static inline uint32_t estimator_phase_turn(const estimator_t *self, uint32_t i) {
    return self->predictor.tone[i].phase_turn;
}

#endif
