#include "spectrum.h"

#include "cosine_table.h"

_Static_assert(SPECTRUM_POINTS == COSINE_POINTS, "one table entry a sample of the window");

enum {
    QUARTER = SPECTRUM_POINTS / 4,
    SAMPLE_LIMIT = 1 << 29, // um/s2; the filters may overshoot, the bins must not overflow
};

void spectrum_init(spectrum_t *self, uint32_t tick_rate_Hz) {
    *self = (spectrum_t){.next_bin = SPECTRUM_BINS};
    for (uint32_t rate = tick_rate_Hz; rate > SPECTRUM_RATE_Hz; rate /= 2u) {
        self->stages++;
    }
    const uint32_t slices = 1u << self->stages;
    self->slice_bins = (SPECTRUM_BINS + slices - 1u) / slices;
}

// Half-band low-pass: every other coefficient is zero, the rest symmetric about the middle one.
static int32_t half_band(const int32_t line[SPECTRUM_TAPS - 1], int32_t newest) {
    const int64_t outer = (int64_t)newest + line[9];
    const int64_t inner = (int64_t)line[1] + line[7];
    const int64_t centre = (int64_t)line[3] + line[5];
    const int64_t sum_q16 = 636 * outer - 3808 * inner + 19556 * centre + 32768 * (int64_t)line[4];
    return (int32_t)(sum_q16 >> 16);
}

// One stage of decimation by two. Returns true iff *value is an output sample.
static bool decimate(spectrum_stage_t *stage, int32_t *value) {
    const int32_t newest = *value;
    stage->is_odd = !stage->is_odd;
    const bool has_output = !stage->is_odd;
    if (has_output) {
        *value = half_band(stage->line, newest);
    }
    for (uint32_t i = SPECTRUM_TAPS - 2; i > 0; i--) {
        stage->line[i] = stage->line[i - 1];
    }
    stage->line[0] = newest;
    return has_output;
}

static bool decimate_all(spectrum_t *self, int32_t *value) {
    for (uint32_t i = 0; i < self->stages; i++) {
        if (!decimate(&self->stage[i], value)) {
            return false;
        }
    }
    return true;
}

static spectrum_turn_t turn_at(uint32_t angle) {
    return (spectrum_turn_t){
        .cos_q31 = cosine_q25[angle % SPECTRUM_POINTS] * 64,
        .sin_q31 = cosine_q25[(angle - QUARTER) % SPECTRUM_POINTS] * 64,
    };
}

static void start_round(spectrum_t *self, int32_t sample) {
    self->newest = (self->newest + 1u) % SPECTRUM_POINTS;
    self->window_turn = turn_at(self->newest + 1u);
    self->difference = sample - self->sample[self->newest];
    self->sample[self->newest] = sample;
    self->next_bin = 0;
}

// The high word of a bin is its amplitude in um/s2: window length and table format add up to 32
// bits.
static int32_t high_word(int64_t value) {
    return (int32_t)(value >> 32);
}

static void slide_bin(spectrum_t *self, uint32_t k) {
    const uint32_t angle = (k * self->newest) % SPECTRUM_POINTS;
    spectrum_bin_t *bin = &self->bin[k];
    bin->re += (int64_t)self->difference * cosine_q25[angle];
    bin->im -= (int64_t)self->difference * cosine_q25[(angle - QUARTER) % SPECTRUM_POINTS];
}

// Power of bin k under the Hann window, whose first sample is the oldest one in the ring: the two
// neighbours enter with half weight (the Q31 product's high word), turned by that sample's angle.
static uint64_t windowed_power(const spectrum_t *self, uint32_t k) {
    const spectrum_turn_t turn = self->window_turn;
    const int32_t low_re = high_word(self->bin[k - 1].re);
    const int32_t low_im = high_word(self->bin[k - 1].im);
    const int32_t high_re = high_word(self->bin[k + 1].re);
    const int32_t high_im = high_word(self->bin[k + 1].im);
    const int32_t side_re = high_word((int64_t)(low_re + high_re) * turn.cos_q31 +
                                      (int64_t)(low_im - high_im) * turn.sin_q31);
    const int32_t side_im = high_word((int64_t)(low_im + high_im) * turn.cos_q31 +
                                      (int64_t)(high_re - low_re) * turn.sin_q31);
    const int32_t re = high_word(self->bin[k].re) - side_re;
    const int32_t im = high_word(self->bin[k].im) - side_im;
    return (uint64_t)((int64_t)re * re) + (uint64_t)((int64_t)im * im);
}

spectrum_span_t spectrum_step(spectrum_t *self, int32_t accel_um_s2) {
    int32_t sample = accel_um_s2;
    if (decimate_all(self, &sample)) {
        start_round(self, clamp_i32(sample, -SAMPLE_LIMIT, SAMPLE_LIMIT));
    }
    if (self->next_bin == SPECTRUM_BINS) {
        return (spectrum_span_t){0, 0, false};
    }
    const uint32_t first = self->next_bin;
    const uint32_t left = SPECTRUM_BINS - first;
    const uint32_t end = first + (left < self->slice_bins ? left : self->slice_bins);
    for (uint32_t k = first; k < end; k++) {
        slide_bin(self, k);
        if (k >= 2) {
            self->power[k - 1] = windowed_power(self, k - 1);
        }
    }
    self->next_bin = end;
    return (spectrum_span_t){
        .first = first < 2u ? 1u : first - 1u,
        .end = end - 1u,
        .is_round_end = end == SPECTRUM_BINS,
    };
}
