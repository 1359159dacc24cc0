#include "estimator_fft.h"

#include <stddef.h>

#include "trig.h"

enum {
    SAMPLE_RATE_Hz = 1000, // the transform's, as far as the tick rate allows
    WINDOW_ms = 1024,
    BIN_LOG2 = 24,    // a bin in turns a sample at 250 Hz, Q32
    TRACKED_LOG2 = 8, // as many samples at 250 Hz are a window
    POWERS_A_STEP = 4,
    ENERGY_SHIFT = 6, // room for the sum of all powers
    LOBE_BINS = 2,    // on each side of a tone's bin, that are the tone's
    AMP_LIMIT = 1 << 30,
    SIGMA_DIVISOR = 10, // bins a noise-to-amplitude ratio: twice the bound of 256 samples
};

// 0.075 x 2^24 x 8^3: what the image moves a frequency by at most, over its bin in eighths cubed.
#define IMAGE_Q24_Q9 644245094u

// Instructions of a step, roughly; what a hop has of them at most.
enum {
    READ_COST = 440,
    CHOOSE_COST = 350,
    REFINE_COST = 450,
    DECIDE_COST = 900,
    PUBLISH_COST = 1000,
    STEPS_COST = FFT_LAST_BIN / POWERS_A_STEP * READ_COST + TRACKER_CANDIDATES * CHOOSE_COST +
                 TRACKER_TONES * REFINE_COST + DECIDE_COST + PUBLISH_COST,
};

static const uint16_t step_cost[] = {
    [ESTIMATOR_FFT_READ] = READ_COST,       [ESTIMATOR_FFT_CHOOSE] = CHOOSE_COST,
    [ESTIMATOR_FFT_REFINE] = REFINE_COST,   [ESTIMATOR_FFT_DECIDE] = DECIDE_COST,
    [ESTIMATOR_FFT_PUBLISH] = PUBLISH_COST,
};

static uint32_t points(const estimator_fft_t *self) {
    return 1u << self->fft.points_log2;
}

// The last samples are worth nothing: the sensor was lost.
static void restart(estimator_fft_t *self) {
    const int32_t known = -estimate_filter_memory(&self->known);
    estimate_forget(&self->known);
    self->full_samples = known;
    self->clean_samples = known;
    self->stage = ESTIMATOR_FFT_WAIT;
    self->job_ticks = UINT32_MAX;
}

void estimator_fft_init(estimator_fft_t *self, const estimator_cfg_t *cfg) {
    const uint32_t rate_Hz = cfg->tick_rate_Hz;
    const uint32_t hop_ms = cfg->hop_ms > ESTIMATOR_FFT_HOP_ms ? cfg->hop_ms : ESTIMATOR_FFT_HOP_ms;
    *self = (estimator_fft_t){.hop_ticks = hop_ms * rate_Hz / 1000u};
    estimate_init(&self->known, cfg, SAMPLE_RATE_Hz, WINDOW_ms * rate_Hz / 1000u);
    fft_init(&self->fft, rate_Hz < SAMPLE_RATE_Hz ? FFT_MAX_LOG2 - 1u : FFT_MAX_LOG2);
    const uint32_t ticks = ESTIMATOR_FFT_HOP_ms * rate_Hz / 1000u;
    self->credit_a_tick = (int32_t)((fft_cost(&self->fft) + STEPS_COST) / ticks + 1u);
    restart(self);
}

// Windows that hold something from before say nothing about now that can be trusted.
static void contradict(estimator_fft_t *self) {
    const int32_t since =
        (int32_t)(self->known.predictor.suspect_ticks >> self->known.decimate.stages) -
        estimate_filter_memory(&self->known);
    self->clean_samples = since < self->clean_samples ? since : self->clean_samples;
    self->is_clean = false;
    self->is_published_clean = false;
    estimate_end(&self->known);
    predictor_disarm(&self->known.predictor);
}

static bool start_job(estimator_fft_t *self) {
    self->credit = self->credit_a_tick;
    if (self->sample_age_ticks != 0 || self->job_ticks < self->hop_ticks ||
        self->full_samples < (int32_t)points(self)) {
        return false;
    }
    fft_start(&self->fft);
    self->is_clean = self->clean_samples >= (int32_t)points(self);
    self->window_age_ticks = 0;
    self->job_ticks = 0;
    self->stage = ESTIMATOR_FFT_TRANSFORM;
    return true;
}

static void start_reading(estimator_fft_t *self) {
    const tracker_window_t window = {
        .points_log2 = TRACKED_LOG2,
        .last_power = FFT_LAST_BIN,
        .is_longest = true,
    };
    // Every transform speaks for itself: nothing of the last one's tones goes into the search.
    self->known.tracker.tones = 0;
    self->known.tracker.hints = 0;
    tracker_start_search(&self->known.tracker, &window);
    velocity_start(&self->known.velocity, TRACKED_LOG2);
    self->next_power = 1;
    self->energy = 0;
    self->refined = 0;
    self->constant_um_s2 = self->fft.mean_um_s2;
    self->stage = ESTIMATOR_FFT_READ;
}

static uint64_t power_of(fft_bin_t bin) {
    return (uint64_t)((int64_t)bin.re * bin.re) + (uint64_t)((int64_t)bin.im * bin.im);
}

static void read(estimator_fft_t *self) {
    const uint32_t first = self->next_power;
    const uint32_t left = FFT_LAST_BIN + 1u - first;
    const uint32_t end = first + (left < POWERS_A_STEP ? left : POWERS_A_STEP);
    for (uint32_t k = first; k < end; k++) {
        self->power[k] = power_of(self->fft.bin[k]);
        self->energy += self->power[k] >> ENERGY_SHIFT;
    }
    tracker_read(&self->known.tracker, self->power, first, end);
    velocity_read(&self->known.velocity, self->power, first, end);
    self->next_power = end;
    if (end > FFT_LAST_BIN) {
        self->rest = self->energy;
        self->rest_bins = FFT_LAST_BIN;
        velocity_end(&self->known.velocity);
        self->stage = ESTIMATOR_FFT_CHOOSE;
    }
}

static void choose(estimator_fft_t *self) {
    if (tracker_choose(&self->known.tracker, self->power)) {
        self->stage = self->known.tracker.starts > 0 ? ESTIMATOR_FFT_REFINE : ESTIMATOR_FFT_DECIDE;
    }
}

// 1 / the Hann window's response d bins off a bin's middle, Q15: pi d (1 - d^2) / sin(pi d) by its
// series, to 3e-5 for |d| <= 1/2.
static int32_t lobe_q15(int32_t d_q15) {
    const int32_t d2_q15 = (d_q15 * d_q15) >> 15;
    int32_t sum_q15 = 2524 + ((700 * d2_q15) >> 15);
    sum_q15 = 8164 + ((sum_q15 * d2_q15) >> 15);
    sum_q15 = 21133 + ((sum_q15 * d2_q15) >> 15);
    return 32768 + ((sum_q15 * d2_q15) >> 15);
}

// Deviation of a frequency without any noise. Below two bins it is not known at all.
static uint32_t image_turn(uint32_t turn) {
    const uint32_t bin_q3 = turn >> (BIN_LOG2 - 3);
    return bin_q3 < 16u ? turn : IMAGE_Q24_Q9 / (bin_q3 * bin_q3 * bin_q3);
}

// Angle of a bin at the middle of the window, where every odd one has the other sign.
static uint32_t angle_of(fft_bin_t bin, uint32_t k) {
    const uint32_t bits = (uint32_t)abs_i32(bin.re) | (uint32_t)abs_i32(bin.im) | 1u;
    const uint32_t up = (uint32_t)__builtin_clz(bits) - 1u;
    const int32_t one = up > 0 ? 1 << (up - 1u) : 1; // bins are within 2^30
    return atan2_turn(bin.im * one, bin.re * one) + (k << 31);
}

// Mean of a tone over the window: amp cos(phase) sin(pi f) / (pi f), f in bins.
static int32_t mean_of(const tracker_tone_t *tone) {
    const uint32_t pi_bin_q4 = (tone->turn >> (BIN_LOG2 - 4)) * 201u / 64u;
    const int64_t middle = ((int64_t)tone->amp_um_s2 * sincos_q30(tone->phase_turn).cos) >> 30;
    const int64_t mean = (middle * sincos_q30(tone->turn << (31 - BIN_LOG2)).sin) >> 30;
    return (int32_t)mean / (int32_t)pi_bin_q4 * 16;
}

// A tone's lobe is not part of what is left.
static void take_out(estimator_fft_t *self, uint32_t k) {
    const uint32_t first = k > LOBE_BINS ? k - LOBE_BINS : 1u;
    const uint32_t last = k + LOBE_BINS < FFT_LAST_BIN ? k + LOBE_BINS : FFT_LAST_BIN;
    for (uint32_t i = first; i <= last; i++) {
        if (self->power[i] != 0) {
            self->rest -= self->power[i] >> ENERGY_SHIFT;
            self->power[i] = 0;
            self->rest_bins--;
        }
    }
}

static void refine(estimator_fft_t *self) {
    const uint32_t turn = self->known.tracker.start[self->refined].turn;
    const uint32_t nearest = (turn + (1u << (BIN_LOG2 - 1))) >> BIN_LOG2;
    const uint32_t k = nearest < FFT_LAST_BIN ? nearest : FFT_LAST_BIN;
    const int32_t off_q15 = (int32_t)(turn - (k << BIN_LOG2)) >> (BIN_LOG2 - 15);
    const uint64_t power = power_of(self->fft.bin[k]);
    const int64_t amp = ((int64_t)sqrt_fast_u64(power) * lobe_q15(off_q15)) >> 15;
    self->tone[self->refined] = (tracker_tone_t){
        .turn = turn,
        .phase_turn = angle_of(self->fft.bin[k], k),
        .sigma_turn = image_turn(turn),
        .amp_um_s2 = (int32_t)clamp_i64(amp, 1, AMP_LIMIT),
    };
    take_out(self, k);
    self->constant_um_s2 -= mean_of(&self->tone[self->refined]);
    self->refined++;
    if (self->refined >= self->known.tracker.starts || self->refined == TRACKER_TONES) {
        self->stage = ESTIMATOR_FFT_DECIDE;
    }
}

// What the tones leave, a bin, as the standard deviation of white noise at 250 Hz, whose Hann
// powers are 6 / 256 of its square.
static int32_t residual_um_s2(uint64_t rest) {
    const uint64_t most = (UINT64_C(1) << 50) - 1u;
    return (int32_t)sqrt_fast_u64((rest < most ? rest : most) * (256u << ENERGY_SHIFT) / 6u);
}

// part / whole in Q16, at most 1.
static uint32_t share_q16(uint64_t part, uint64_t whole) {
    if (part >= whole) {
        return whole == 0 ? 0 : 1u << 16;
    }
    const uint32_t zeros = leading_zeros_u64(whole);
    const uint32_t down = zeros < 48u ? 48u - zeros : 0;
    return ((uint32_t)(part >> down) << 16) / ((uint32_t)(whole >> down) + 1u);
}

static void decide(estimator_fft_t *self) {
    const uint64_t rest = self->rest / self->rest_bins;
    const uint64_t rests = rest * FFT_LAST_BIN;
    const uint64_t tones = self->energy > rests ? self->energy - rests : 0;
    const int32_t residual = residual_um_s2(rest);
    for (uint32_t i = 0; i < self->refined; i++) {
        tracker_tone_t *tone = &self->tone[i];
        const uint64_t noise = ((uint64_t)(uint32_t)residual << BIN_LOG2) /
                               ((uint64_t)(uint32_t)tone->amp_um_s2 * SIGMA_DIVISOR);
        tone->sigma_turn += (uint32_t)(noise < INT32_MAX ? noise : INT32_MAX);
    }
    const bool is_good = estimate_decide(&self->known, self->tone, self->refined, residual,
                                         share_q16(tones, self->energy));
    self->residual_um_s2 = residual;
    self->stage = is_good ? ESTIMATOR_FFT_PUBLISH : ESTIMATOR_FFT_WAIT;
}

// What the image makes of a tone at the end of its window, pi times as many turns off.
static int32_t image_um_s2(const tracker_tone_t *tone) {
    return (int32_t)(((uint64_t)(uint32_t)tone->amp_um_s2 * image_turn(tone->turn) * 3u) >>
                     BIN_LOG2);
}

static void publish(estimator_fft_t *self) {
    const uint32_t ratio = 1u << self->known.decimate.stages;
    const uint32_t since_middle =
        self->window_age_ticks + DECIMATE_DELAY(ratio) + (points(self) / 2u - 1u) * ratio;
    const predictor_rest_t rest = {
        .mean_um_s2 = self->constant_um_s2,
        .is_clear = self->known.tracker.is_clear,
        .noise_um_s2 = self->residual_um_s2 + self->residual_um_s2 / 4 +
                       image_um_s2(&self->known.tracker.tone[0]),
    };
    estimate_publish(&self->known, 2u * since_middle, &rest);
    self->known.window_ms = WINDOW_ms;
    self->is_published_clean = self->is_clean;
    if (!self->is_clean) {
        predictor_disarm(&self->known.predictor); // its samples contradict what is still in there
    }
    self->stage = ESTIMATOR_FFT_WAIT;
}

// Returns false iff the credit does not do for more, or nothing is to be done.
static bool work_on(estimator_fft_t *self) {
    static void (*const step[])(estimator_fft_t *) = {
        [ESTIMATOR_FFT_READ] = read,       [ESTIMATOR_FFT_CHOOSE] = choose,
        [ESTIMATOR_FFT_REFINE] = refine,   [ESTIMATOR_FFT_DECIDE] = decide,
        [ESTIMATOR_FFT_PUBLISH] = publish,
    };
    if (self->stage == ESTIMATOR_FFT_WAIT) {
        return start_job(self);
    }
    if (self->stage == ESTIMATOR_FFT_TRANSFORM) {
        if (!fft_work(&self->fft, &self->credit)) {
            return false;
        }
        start_reading(self);
    }
    if (self->credit < step_cost[self->stage]) {
        return false;
    }
    self->credit -= step_cost[self->stage];
    step[self->stage](self);
    return true;
}

static void age(estimator_fft_t *self) {
    self->sample_age_ticks++;
    self->window_age_ticks++;
    self->job_ticks = increment_sat_u32(self->job_ticks);
    estimate_age(&self->known);
}

static void take(estimator_fft_t *self, const estimator_in_t *in) {
    age(self);
    if (predictor_step(&self->known.predictor, in->accel_um_s2, in->is_good) == PREDICTOR_CHANGED) {
        contradict(self);
    }
    if (in->is_lost) {
        restart(self);
    }
    int32_t sample_um_s2;
    if (estimate_sample(&self->known, in, &sample_um_s2)) {
        fft_push(&self->fft, sample_um_s2);
        self->full_samples += self->full_samples < INT32_MAX ? 1 : 0;
        self->clean_samples += self->clean_samples < INT32_MAX ? 1 : 0;
        self->sample_age_ticks = 0;
    }
}

// Ticks that went by without a sample: each a held one.
static void bridge(estimator_fft_t *self, const estimator_in_t *in) {
    const estimator_in_t held = {.accel_um_s2 = in->accel_um_s2};
    for (uint32_t i = 0; i < in->lost_ticks; i++) {
        take(self, &held);
    }
}

void estimator_fft_step(estimator_fft_t *self, const estimator_in_t *in) {
    if (in->lost_ticks != 0) {
        bridge(self, in);
    }
    take(self, in);
    self->credit += in->lost_ticks == 0 ? self->credit_a_tick : 0;
    while (work_on(self)) {
    }
    estimate_judge(&self->known, !self->is_published_clean);
}
