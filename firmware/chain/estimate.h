/// What an estimator knows of the vibration, and what all of them have in common: components that
/// run on at every tick, the watch over them, and when they are to be trusted.
#ifndef ESTIMATE_H
#define ESTIMATE_H

#include "decimate.h"
#include "predictor.h"
#include "spread.h"
#include "tracker.h"
#include "velocity.h"

#define ESTIMATOR_TONES PREDICTOR_TONES

/// Lost ticks in a row that an estimator goes on through. Each costs what a tick's sample does; a
/// tick that makes up for some leaves the work of its own on windows to the next one.
#define ESTIMATOR_MOST_BRIDGED 2u

typedef struct {
    int32_t method; ///< quiesce_estimator_t
    uint32_t tick_rate_Hz;
    uint32_t longest_ms; ///< 128, 256, 512 or 1024; of method fit
    uint32_t hop_ms;     ///< least time from one job's start to the next one's
    tracker_cfg_t tracker;
    spread_cfg_t spread; ///< of method fit
} estimator_cfg_t;

typedef struct {
    int32_t accel_um_s2; ///< before DC removal, |x| < 2^29
    bool is_good;        ///< else accel_um_s2 is a held value
    bool is_lost;        ///< the sensor is lost, or too many ticks are: start anew
    uint32_t lost_ticks; ///< just before this one, 0 .. ESTIMATOR_MOST_BRIDGED: each a held sample
} estimator_in_t;

/// A published component. Its phase is the predictor's.
typedef struct {
    int32_t freq_uHz;
    int32_t amp_um_s2;
    int32_t displacement_nm; ///< amplitude; saturates
} estimator_tone_t;

/// The first member of every estimator.
typedef struct {
    predictor_t predictor;
    tracker_t tracker;
    velocity_t velocity;
    spread_t spread; ///< of what holds no steady component
    decimate_t decimate;
    uint8_t method;
    bool has_published;                     ///< in this tick
    bool is_valid;                          ///< tone[0] can be trusted now
    uint8_t stages;                         ///< 2^stages ticks are 4 ms
    uint32_t age_ticks;                     ///< since tone[0] was last valid, saturating
    estimator_tone_t tone[ESTIMATOR_TONES]; ///< last published; dominant one first, 0 Hz: none
    int32_t sigma_uHz;                      ///< expected of tone[0].freq_uHz
    uint16_t window_ms;                     ///< that they come from
    uint8_t failures;                       ///< times in a row that trust in tone[0] did not last
    bool is_plain;                          ///< the last fit is to be trusted at once
    uint32_t steady_turn;                   ///< where tone[0] has stayed ..
    uint32_t steady_amp_um_s2;
    uint32_t steady_ticks; ///< .. for so long, not contradicted by a sample
    uint32_t trust_ticks;  ///< of them that make up for noise
    uint32_t valid_ticks;  ///< that it has been valid for, since trust last ended; wraps
} estimate_t;

/// sample_rate_Hz: that the estimator works at; window_ticks: of its longest window.
void estimate_init(estimate_t *self, const estimator_cfg_t *cfg, uint32_t sample_rate_Hz,
                   uint32_t window_ticks);

/// Nothing is known any more. Where the samples say so, estimate_end first.
void estimate_forget(estimate_t *self);

/// As tracker_decide. A clear fit is to be trusted at once, unless that did not last the last times
/// and the window is the longest: broadband motion looks like a component for a moment.
bool estimate_decide(estimate_t *self, const tracker_tone_t *tones, uint32_t count,
                     int32_t residual_um_s2, uint32_t explained_q16);

/// What was published is contradicted, or no longer clear: trust in it has lasted, or failed.
void estimate_end(estimate_t *self);

/// The tracker's tones become the published ones. half_ticks: twice the ticks from the moment that
/// their phases belong to until now.
void estimate_publish(estimate_t *self, uint32_t half_ticks, const predictor_rest_t *rest);

/// Samples at the decimated rate whose filters still remember what was before.
int32_t estimate_filter_memory(const estimate_t *self);

/// A tick's start.
static inline void estimate_age(estimate_t *self) {
    self->steady_ticks = self->predictor.is_armed ? increment_sat_u32(self->steady_ticks) : 0;
    self->has_published = false;
}

/// Takes a tick's sample in. Returns true iff *sample_um_s2 has become a decimated one.
static inline bool estimate_sample(estimate_t *self, const estimator_in_t *in,
                                   int32_t *sample_um_s2) {
    // A missing sample is best replaced by what was expected of it.
    const int32_t sample = in->is_good || !self->predictor.is_armed
                               ? in->accel_um_s2
                               : self->predictor.prediction_um_s2;
    *sample_um_s2 = clamp_i32(sample, -DECIMATE_LIMIT, DECIMATE_LIMIT);
    return decimate_step(&self->decimate, sample_um_s2);
}

/// A tick's end. Trusted at once where a change would be seen soon, else after the samples of
/// another one and a half windows have not contradicted it and the frequency has stayed within 8 %.
/// is_held: it is in doubt for another reason.
static inline void estimate_judge(estimate_t *self, bool is_held) {
    self->is_valid = self->tracker.is_valid && self->predictor.is_armed && !is_held &&
                     (self->is_plain || self->steady_ticks >= self->trust_ticks);
    self->valid_ticks += self->is_valid ? 1u : 0u;
    self->age_ticks = self->is_valid ? 0 : increment_sat_u32(self->age_ticks);
}

/// Phase of a published component at this tick, in turns Q32: acceleration = amp cos(phase).
static inline uint32_t estimate_phase_turn(const estimate_t *self, uint32_t i) {
    return self->predictor.tone[i].phase_turn;
}

#endif
