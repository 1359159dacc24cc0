#include "condition.h"

#include "at_start.h"

// What a single missing sample takes off a run of good ones: a sensor at half our rate never counts
// as good, one that misses a tick in ten does.
#define SLIP_COSTS_TICKS 4u

AT_START void condition_init(condition_t *self, const condition_cfg_t *cfg) {
    const int64_t omega_q32 = radians_a_tick_q32(cfg->dc_cutoff_mHz, cfg->tick_rate_Hz);
    const int64_t one_q32 = INT64_C(1) << 32;
    // w is below 0.013, so that w/(1+w) = w - w^2 to better than the state's resolution needs.
    const int32_t dc_gain_q32 = (int32_t)(omega_q32 - omega_q32 * omega_q32 / one_q32);
    *self = (condition_t){0};
    self->cfg = *cfg;
    self->scale = scale_from_ratio((uint32_t)cfg->scale, 1000u);
    self->dc_gain_q32 = dc_gain_q32;
    self->mean_most = UINT32_MAX / ((uint32_t)dc_gain_q32 + 1u);
    self->last_counts = INT32_MIN; // no ADC reports it
    self->noise.limit = 2u * cfg->min_noise_counts;
    self->noise.window_samples = cfg->tick_rate_Hz / cfg->period_ticks;
}

// One plausible sample: |counts| <= 2^23, so that no difference overflows. The first two are
// measured against 0; the bound of a single sample's weight keeps them harmless.
static bool is_quiet(condition_noise_t *self, int32_t counts) {
    if (self->limit == 0) {
        return false;
    }
    const int32_t difference = counts - self->last_counts;
    const uint32_t bend = (uint32_t)abs_i32(difference - self->last_difference);
    self->last_counts = counts;
    self->last_difference = difference;
    self->activity += bend < 4u * self->limit ? bend : 4u * self->limit;
    self->samples++;
    const bool is_lively = self->activity >= self->limit * self->window_samples;
    const bool is_window_end = self->samples == self->window_samples;
    self->is_quiet = !is_lively && (self->is_quiet || is_window_end);
    if (is_window_end) {
        self->activity = 0;
        self->samples = 0;
    }
    return self->is_quiet;
}

static condition_flag_t classify(condition_t *self, const condition_in_t *in) {
    const int32_t counts = in->counts;
    if (!in->is_fresh) {
        return CONDITION_LOST;
    }
    self->same_samples = counts == self->last_counts ? increment_sat_u32(self->same_samples) : 1u;
    self->last_counts = counts;
    const int32_t full_scale = self->cfg.full_scale_counts;
    // Two's complement reaches one count further below zero.
    if (counts > full_scale || counts < -full_scale - 1) {
        return CONDITION_RANGE;
    }
    if (counts == full_scale || counts <= -full_scale || in->is_saturated) {
        return CONDITION_SATURATED;
    }
    if (self->cfg.stuck_ticks != 0 && self->same_samples >= self->cfg.stuck_ticks) {
        return CONDITION_STUCK;
    }
    return is_quiet(&self->noise, counts) ? CONDITION_QUIET : CONDITION_GOOD;
}

static int32_t scaled(const condition_t *self, int32_t counts) {
    // Both are at most 2^23 in magnitude here, their difference 2^24.
    const int32_t offset_free = (counts - self->cfg.offset_counts) * self->cfg.polarity;
    return scale_apply(&self->scale, offset_free, self->cfg.limit);
}

static void take_good_sample(condition_t *self, int32_t counts) {
    self->held = scaled(self, counts);
    self->bad_ticks = 0;
    self->good_ticks = increment_sat_u32(self->good_ticks);
    if (!self->has_value) {
        self->has_value = true;
        self->dc_q32 = (int64_t)self->held * (INT64_C(1) << 32);
        self->mean_samples = 1;
    }
}

static void follow_dc(condition_t *self, int32_t rest) {
    // Until the plain mean of all samples so far would be slower, the mean is the better start: a
    // record that begins in full swing must not ring through the DC removal.
    if (self->mean_samples <= self->mean_most) {
        self->dc_q32 += rest * (int64_t)(UINT32_MAX / self->mean_samples);
        self->mean_samples++;
    } else {
        self->dc_q32 += (int64_t)rest * self->dc_gain_q32;
    }
}

// The held sample without its DC part; 0 while there is none to trust.
static int32_t without_dc(condition_t *self, condition_flag_t flag) {
    if (!self->has_value || self->cfg.dc_cutoff_mHz == 0) {
        return self->has_value ? self->held : 0;
    }
    const int32_t rest = self->held - (int32_t)(self->dc_q32 >> 32);
    if (flag == CONDITION_GOOD) {
        follow_dc(self, rest);
    }
    return clamp_i32(rest, -self->cfg.limit, self->cfg.limit);
}

// Whether a sample came, or one is missing.
static bool is_due(condition_t *self, bool is_fresh) {
    if (is_fresh || self->cfg.period_ticks == 1u) {
        self->waited_ticks = 0;
        return true;
    }
    self->waited_ticks = increment_sat_u32(self->waited_ticks);
    return self->waited_ticks >= self->cfg.period_ticks;
}

// An average over some 256 samples, floor.
static void follow_losses(condition_t *self, bool is_lost) {
    self->lost_q16 += ((is_lost ? 65536 : 0) - self->lost_q16) >> 8;
    self->is_sparse = self->lost_q16 > self->cfg.most_lost_q16;
}

static void judge(condition_t *self, int32_t counts, condition_flag_t flag) {
    if (flag == CONDITION_GOOD) {
        take_good_sample(self, counts);
        follow_losses(self, false);
        return;
    }
    // A single missing sample now and then is how a sensor's clock meets ours, no illness.
    const bool is_slip = flag == CONDITION_LOST && self->bad_ticks == 0u;
    self->bad_ticks = increment_sat_u32(self->bad_ticks);
    if (self->bad_ticks < self->waited_ticks) {
        self->bad_ticks = self->waited_ticks; // the age of what is held
    }
    self->good_ticks =
        is_slip && self->good_ticks > SLIP_COSTS_TICKS ? self->good_ticks - SLIP_COSTS_TICKS : 0u;
    // A slow sensor's sample is lost once, however long the wait for the next one is. A gap that is
    // a fault by itself does not count: after it the sensor starts anew.
    const uint32_t period_ticks = self->cfg.period_ticks;
    const bool is_one_more = period_ticks <= 1u || self->waited_ticks % period_ticks == 0u;
    if (is_one_more && self->bad_ticks <= self->cfg.max_age_ticks) {
        follow_losses(self, flag == CONDITION_LOST);
    }
}

void condition_step(condition_t *self, const condition_in_t *in, condition_out_t *out) {
    condition_flag_t flag = self->flag;
    if (is_due(self, in->is_fresh)) {
        flag = classify(self, in);
        judge(self, in->counts, flag);
        self->flag = flag;
    }
    if (self->is_sparse && flag == CONDITION_GOOD) {
        flag = CONDITION_LOST;
    }
    const bool is_dead = flag == CONDITION_STUCK || flag == CONDITION_QUIET || self->is_sparse;
    out->flag = flag;
    out->is_fault = is_dead || self->bad_ticks > self->cfg.max_age_ticks;
    if (out->is_fault) {
        // The sensor may come back with another offset: the DC part is learnt anew.
        self->has_value = false;
    }
    out->value = without_dc(self, in->is_fresh ? flag : CONDITION_LOST);
    out->raw = self->held;
    out->good_ticks = self->good_ticks;
}
