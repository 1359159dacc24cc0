#include "estimator_fit.h"

#include <stddef.h>

#include "at_start.h"

enum {
    PAIRS_A_SAMPLE = 92,  // work of a job between two samples, in pairs of samples
    POWERS_A_SAMPLE = 34, // and powers to read
    JOB_SAMPLES = 12,     // that come in while a job runs
    LOST_FITS = 3,        // in a row that do not hold: a longer window is tried
    MOST_FITS = 5,        // to one window
    SUSPEND_ms = 96,      // longest wait for the end of a burst
    CALM_s = 2,           // without a contradiction, before a longer window is tried again
    PURE_Q16 = 52429,     // 80 %: share of the energy that one component must explain
    THIRD_FRACTION = 100, // a third harmonic is within 1 % of three times the fundamental
    SPREAD_HOP_ms = 128,  // an eighth of a window: what it forgets it forgets in time
    STEADY_WINDOWS = 3,   // a component that lasts so long is another motion than the one before
};

AT_START void estimator_fit_init(estimator_fit_t *self, const estimator_cfg_t *cfg) {
    *self = (estimator_fit_t){.job_ticks = UINT32_MAX};
    while (self->longest_level < SPECTRUM_LONGEST &&
           SPECTRUM_POINTS(self->longest_level) * 1000u < cfg->longest_ms * SPECTRUM_RATE_Hz) {
        self->longest_level++;
    }
    estimate_init(&self->known, cfg, SPECTRUM_RATE_Hz,
                  SPECTRUM_POINTS(self->longest_level) * (cfg->tick_rate_Hz / SPECTRUM_RATE_Hz));
    const uint32_t stages = self->known.stages;
    spectrum_init(&self->spectrum, stages);
    tone_fit_init(&self->fit);
    self->slice_pairs = PAIRS_A_SAMPLE >> stages;
    self->slice_powers = POWERS_A_SAMPLE >> stages;
    self->hop_ticks = cfg->hop_ms * cfg->tick_rate_Hz / 1000u;
    self->spread_hop_ticks = SPREAD_HOP_ms * cfg->tick_rate_Hz / 1000u;
    self->spread_ticks = self->spread_hop_ticks - self->job_ticks; // the first one is due
    self->clean_samples = -estimate_filter_memory(&self->known);
    self->most_level = self->longest_level;
    self->suspend_most_ticks = SUSPEND_ms * cfg->tick_rate_Hz / 1000u;
    self->calm_enough_ticks = CALM_s * cfg->tick_rate_Hz;
}

static void forget(estimator_fit_t *self) {
    self->is_suspended = false;
    self->stage = ESTIMATOR_FIT_WAIT;
    estimate_forget(&self->known);
}

// The windows start anew; the last `ticks` ticks already belong to the new vibration.
static void restart(estimator_fit_t *self, uint32_t ticks) {
    const uint32_t longest = (uint32_t)SPECTRUM_RING << self->known.stages;
    const int32_t known = (int32_t)((ticks < longest ? ticks : longest) >> self->known.stages);
    const int32_t clean = known - estimate_filter_memory(&self->known);
    self->clean_samples = clean < self->clean_samples ? clean : self->clean_samples;
    self->most_level = self->longest_level;
    forget(self);
}

// The samples contradict what was published. After a window shorter than the longest, which is
// younger than the change before: the vibration wanders, and a still shorter one must do for a
// while; where none is left, it never was of one component.
static void contradict_short(estimator_fit_t *self) {
    if (self->published_level > 0) {
        self->most_level = self->published_level - 1u;
    } else {
        self->is_pure = false;
    }
    self->calm_ticks = 0;
    estimate_end(&self->known);
    forget(self);
}

// After the longest one: the vibration has changed, or there was a burst. The estimate is not valid
// and no job runs until that is known; the new windows' samples are counted meanwhile.
static void suspend(estimator_fit_t *self) {
    self->is_suspended = true;
    self->suspended_ticks = 0;
    self->stage = ESTIMATOR_FIT_WAIT;
}

static void judge_sample(estimator_fit_t *self, predictor_verdict_t verdict) {
    if (verdict == PREDICTOR_BACK) {
        self->is_suspended = false;
    } else if (verdict == PREDICTOR_CHANGED) {
        if (self->published_level == self->longest_level) {
            suspend(self);
        } else {
            contradict_short(self);
        }
    }
    if (self->is_suspended) {
        self->suspended_ticks++;
        if (self->suspended_ticks == self->suspend_most_ticks) {
            estimate_end(&self->known);
            restart(self, self->known.predictor.suspect_ticks + self->suspended_ticks);
        }
    }
}

// A vibration that has stopped wandering gets longer windows again, step by step.
static void calm_down(estimator_fit_t *self) {
    self->calm_ticks++;
    if (self->most_level < self->longest_level && self->calm_ticks >= self->calm_enough_ticks) {
        self->most_level++;
        self->calm_ticks = 0;
    }
}

static bool choose_level(estimator_fit_t *self) {
    const uint32_t shortest = self->is_pure ? 0 : self->longest_level;
    const uint32_t longest = self->is_pure ? self->most_level : self->longest_level;
    for (uint32_t level = longest + 1u; level-- > shortest;) {
        if (self->clean_samples >= (int32_t)SPECTRUM_POINTS(level)) {
            self->level = level;
            return true;
        }
    }
    return false;
}

// Whether a job on a window that has just failed would only keep the next longer one waiting.
static bool is_worth_waiting(const estimator_fit_t *self) {
    return self->known.tracker.misses > 0 && self->level < self->most_level &&
           self->clean_samples + JOB_SAMPLES >= (int32_t)SPECTRUM_POINTS(self->level + 1u);
}

static void start_job(estimator_fit_t *self) {
    if (self->is_suspended || self->job_ticks < self->hop_ticks || !choose_level(self) ||
        is_worth_waiting(self)) {
        return;
    }
    // The window's own mean holds some of the vibration; the last fit knows better.
    const int32_t constant_um_s2 = self->known.predictor.is_armed && !self->has_drift
                                       ? self->fit.constant_um_s2
                                       : spectrum_mean_um_s2(&self->spectrum, self->level);
    spectrum_want_powers(&self->spectrum, self->level, constant_um_s2);
    self->spread_ticks += self->job_ticks; // after 49 days one reading is a hop late
    self->job_ticks = 0;
    self->stage = ESTIMATOR_FIT_SEARCH;
}

static void search(estimator_fit_t *self) {
    if (!self->spectrum.has_powers) {
        return;
    }
    const tracker_window_t window = {
        .points_log2 = SPECTRUM_POINTS_LOG2(self->level),
        .last_power = spectrum_last_power(self->level),
        .is_longest = self->level == self->longest_level,
    };
    tracker_start_search(&self->known.tracker, &window);
    velocity_start(&self->known.velocity, SPECTRUM_POINTS_LOG2(self->level));
    self->next_power = 1;
    self->stage = ESTIMATOR_FIT_READ;
}

static void read(estimator_fit_t *self) {
    const uint32_t last = spectrum_last_power(self->level);
    uint32_t end = self->next_power + self->slice_powers;
    end = end < last + 1u ? end : last + 1u;
    tracker_read(&self->known.tracker, self->spectrum.power, self->next_power, end);
    velocity_read(&self->known.velocity, self->spectrum.power, self->next_power, end);
    self->next_power = end;
    if (end > last) {
        velocity_end(&self->known.velocity);
        self->stage = ESTIMATOR_FIT_CHOOSE;
    }
}

// Candidates found: takes the window's samples in.
static void start_gathering(estimator_fit_t *self) {
    const tone_fit_window_t window = {
        .ring = self->spectrum.sample,
        .ring_mask = SPECTRUM_RING - 1u,
        .newest = self->spectrum.newest,
        .points_log2 = SPECTRUM_POINTS_LOG2(self->level),
        .mean_um_s2 = spectrum_mean_um_s2(&self->spectrum, self->level),
        .size_um_s2 = 3u * self->known.tracker.strongest_um_s2,
    };
    tone_fit_start(&self->fit, &window);
    self->job_age_ticks = self->sample_age_ticks;
    self->stage = ESTIMATOR_FIT_GATHER;
}

// A job's end. What the window holds is no steady component, or not for long: how broad is it?
static void end_job(estimator_fit_t *self) {
    estimate_t *known = &self->known;
    self->stage = ESTIMATOR_FIT_WAIT;
    const uint32_t points_log2 = SPECTRUM_POINTS_LOG2(self->level);
    if (!spread_is_wanted(&known->spread) || points_log2 != SPREAD_POINTS_LOG2) {
        return;
    }
    if (!known->is_valid && self->spread_ticks + self->job_ticks >= self->spread_hop_ticks) {
        self->stage = ESTIMATOR_FIT_SPREAD;
    } else if (known->is_valid && known->valid_ticks >= STEADY_WINDOWS * known->trust_ticks) {
        spread_forget(&known->spread);
    }
}

// Before the next job needs the powers' place. It does not wait for that: what reads them slows
// nothing down.
static void spread(estimator_fit_t *self) {
    const velocity_t *band = &self->known.velocity;
    spread_take(&self->known.spread, self->spectrum.power, band->first_bin, band->end_bin);
    self->spread_ticks = 0u - self->job_ticks;
    self->stage = ESTIMATOR_FIT_WAIT;
    start_job(self);
}

static void choose(estimator_fit_t *self) {
    tracker_t *tracker = &self->known.tracker;
    if (!tracker_choose(tracker, self->spectrum.power)) {
        return;
    }
    // A drift goes on until a fit finds none.
    self->has_drift =
        tracker->has_drift || (self->is_drifting && self->level == self->longest_level);
    if (tracker->starts == 0) {
        (void)estimate_decide(&self->known, NULL, 0, 0, 0);
        end_job(self);
        return;
    }
    start_gathering(self);
}

static void gather(estimator_fit_t *self) {
    self->fit.window.ring = self->spectrum.sample; // the state may have been copied since
    if (!tone_fit_step(&self->fit, self->slice_pairs)) {
        return;
    }
    uint32_t turns[TRACKER_TONES];
    for (uint32_t i = 0; i < self->known.tracker.starts; i++) {
        turns[i] = self->known.tracker.start[i].turn;
    }
    tone_fit_set(&self->fit, turns, self->known.tracker.starts, self->has_drift);
    self->fits = 1;
    self->residual_without_um_s2 = 0;
    self->stage = ESTIMATOR_FIT_FIT;
}

// Starts of one more fit to the same window: the last fit's frequencies without those that turned
// out to be too slow for the window, which count as drift. Returns their number.
static uint32_t next_starts(estimator_fit_t *self, uint32_t *turns) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < self->fit.tones; i++) {
        const uint32_t turn = self->fit.tone[i].turn;
        if (tracker_is_drift(&self->known.tracker, turn)) {
            self->has_drift = true;
        } else {
            turns[count] = turn;
            count++;
        }
    }
    return count;
}

// Whether the fit has moved a frequency so far that its linear model no longer holds there.
static bool has_moved(const estimator_fit_t *self) {
    for (uint32_t i = 0; i < self->fit.tones; i++) {
        if (abs_i32(self->fit.tone[i].shift_q29) > TRACKER_CONVERGED_Q29) {
            return true;
        }
    }
    return false;
}

// Decides about a drift for the next fit to the same window: tries one where something is missing,
// takes it back where it explains next to nothing of that. Returns true iff that changes the fit.
static bool reconsider_drift(estimator_fit_t *self, bool had_drift) {
    const int32_t residual_um_s2 = self->fit.residual_um_s2;
    if (self->residual_without_um_s2 != 0) {
        const bool is_real = residual_um_s2 < self->residual_without_um_s2 / 8 * 7;
        self->residual_without_um_s2 = 0;
        self->has_drift = is_real;
        self->is_drift_futile = !is_real;
        return !is_real;
    }
    if (!self->has_drift && !self->is_drift_futile &&
        tracker_is_missing_something(&self->known.tracker, residual_um_s2)) {
        self->has_drift = true;
        self->residual_without_um_s2 = residual_um_s2;
    }
    return self->has_drift != had_drift;
}

static void fit_on(estimator_fit_t *self) {
    if (!tone_fit_step(&self->fit, self->slice_pairs)) {
        return;
    }
    uint32_t turns[TRACKER_TONES];
    const bool had_drift = self->has_drift;
    const uint32_t count = next_starts(self, turns);
    const bool is_to_refine = has_moved(self) || reconsider_drift(self, had_drift);
    if (count == 0 || !is_to_refine || self->fits == MOST_FITS) {
        self->stage = ESTIMATOR_FIT_DECIDE;
        return;
    }
    tone_fit_set(&self->fit, turns, count, self->has_drift);
    self->fits++;
}

// Twice the ticks from the middle of the window to this one.
static uint32_t half_ticks_since_middle(const estimator_fit_t *self) {
    const uint32_t ratio = 1u << self->known.stages;
    return 2u * (self->job_age_ticks + DECIMATE_DELAY(ratio)) +
           (SPECTRUM_POINTS(self->level) - 1u) * ratio;
}

// The constant part, run on from the window's end to this tick.
static predictor_rest_t rest_of(const estimator_fit_t *self) {
    const uint32_t half_ticks = SPECTRUM_POINTS(self->level) << self->known.stages >> 1u;
    const int64_t drift_q8 = ((int64_t)self->fit.slope_um_s2 * 256) / half_ticks;
    const int64_t ticks = self->job_age_ticks + DECIMATE_DELAY(1u << self->known.stages);
    const int64_t mean = self->fit.end_um_s2 + ((drift_q8 * ticks) >> 8);
    // A short window knows its noise to some 8 / N only.
    const int32_t residual = clamp_i32(self->fit.residual_um_s2, 0, INT32_MAX / 2);
    return (predictor_rest_t){
        .mean_um_s2 = (int32_t)clamp_i64(mean, -INT32_MAX, INT32_MAX),
        .drift_um_s2_q8 = (int32_t)clamp_i64(drift_q8, -INT32_MAX, INT32_MAX),
        .bend_um_s2 = self->fit.bend_um_s2,
        .is_clear = self->known.tracker.is_clear,
        .noise_um_s2 = residual + (residual >> (SPECTRUM_POINTS_LOG2(self->level) - 3u)),
    };
}

// One component, alone or with the third harmonic that a sticking damper adds to it.
static bool is_one_motion(const tracker_t *tracker) {
    const uint32_t third = 3u * tracker->tone[0].turn;
    return tracker->tones == 1u || (tracker->tones == 2u && gap_u32(third, tracker->tone[1].turn) <=
                                                                third / THIRD_FRACTION);
}

// What the longest window tells about the shorter ones and the next. One component, and what it
// leaves unexplained is not a drift either: then it may only wander.
static void judge_window(estimator_fit_t *self) {
    const tone_fit_t *fit = &self->fit;
    const bool is_missing = tracker_is_missing_something(&self->known.tracker, fit->residual_um_s2);
    self->is_drifting = self->has_drift && !is_missing && fit->bend_um_s2 > fit->residual_um_s2 / 2;
    // Where a drift does not explain what is missing, none needs to be tried the next time.
    self->is_drift_futile &= is_missing;
    self->is_pure = is_one_motion(&self->known.tracker) && fit->explained_q16 >= PURE_Q16 &&
                    !self->has_drift && (!is_missing || self->is_drift_futile);
}

static void publish(estimator_fit_t *self) {
    const predictor_rest_t rest = rest_of(self);
    estimate_publish(&self->known, half_ticks_since_middle(self), &rest);
    self->known.window_ms = (uint16_t)(SPECTRUM_POINTS(self->level) * 1000u / SPECTRUM_RATE_Hz);
    self->published_level = self->level;
    if (self->level == self->longest_level) {
        judge_window(self);
    }
    end_job(self);
}

static void decide(estimator_fit_t *self) {
    tracker_tone_t tones[TRACKER_TONES];
    for (uint32_t i = 0; i < self->fit.tones; i++) {
        const tone_t *tone = &self->fit.tone[i];
        tones[i] = (tracker_tone_t){
            .turn = tone->turn,
            .phase_turn = tone->phase_turn,
            .sigma_turn = tone->sigma_turn,
            .shift_q29 = tone->shift_q29,
            .amp_um_s2 = tone->amp_um_s2,
        };
    }
    const bool is_good = estimate_decide(&self->known, tones, self->fit.tones,
                                         self->fit.residual_um_s2, self->fit.explained_q16);
    if (is_good) {
        self->stage = ESTIMATOR_FIT_PUBLISH;
    } else {
        end_job(self);
    }
    if (self->known.tracker.misses >= LOST_FITS && self->level == self->most_level &&
        self->most_level < self->longest_level) {
        self->most_level++; // so short a window does not help either
    }
}

static void work(estimator_fit_t *self) {
    static void (*const step[])(estimator_fit_t *) = {
        [ESTIMATOR_FIT_WAIT] = start_job, [ESTIMATOR_FIT_SEARCH] = search,
        [ESTIMATOR_FIT_READ] = read,      [ESTIMATOR_FIT_CHOOSE] = choose,
        [ESTIMATOR_FIT_GATHER] = gather,  [ESTIMATOR_FIT_FIT] = fit_on,
        [ESTIMATOR_FIT_DECIDE] = decide,  [ESTIMATOR_FIT_PUBLISH] = publish,
        [ESTIMATOR_FIT_SPREAD] = spread,
    };
    step[self->stage](self);
}

static void take_sample(estimator_fit_t *self, int32_t sample_um_s2) {
    spectrum_start_round(&self->spectrum, sample_um_s2);
    self->clean_samples += self->clean_samples < INT32_MAX ? 1 : 0;
    self->sample_age_ticks = 0;
}

static void age(estimator_fit_t *self) {
    self->sample_age_ticks++;
    self->job_age_ticks++;
    self->job_ticks = increment_sat_u32(self->job_ticks);
    estimate_age(&self->known);
}

static void take(estimator_fit_t *self, const estimator_in_t *in) {
    age(self);
    judge_sample(self, predictor_step(&self->known.predictor, in->accel_um_s2, in->is_good));
    calm_down(self);
    if (in->is_lost) {
        spread_forget(&self->known.spread);
        restart(self, 0);
    }
    int32_t sample_um_s2;
    if (estimate_sample(&self->known, in, &sample_um_s2)) {
        take_sample(self, sample_um_s2);
    }
}

// Ticks that went by without a sample: each a held one.
static void bridge(estimator_fit_t *self, const estimator_in_t *in) {
    const estimator_in_t held = {.accel_um_s2 = in->accel_um_s2};
    for (uint32_t i = 0; i < in->lost_ticks; i++) {
        take(self, &held);
        spectrum_slice(&self->spectrum);
    }
}

void estimator_fit_step(estimator_fit_t *self, const estimator_in_t *in) {
    if (in->lost_ticks != 0) {
        bridge(self, in);
    }
    take(self, in);
    if (in->lost_ticks == 0) {
        work(self);
    }
    spectrum_slice(&self->spectrum);
    estimate_judge(&self->known, self->is_suspended);
}
