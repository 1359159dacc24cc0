#include "spectrum.h"

#include "cosine_table.h"

enum { QUARTER = COSINE_POINTS / 4 };

// First slot of each window's bins; the bins of a window reach one beyond its last power.
static const uint8_t first_slot[SPECTRUM_LEVELS + 1] = {0, 8, 8 + 15, 8 + 15 + 28, SPECTRUM_BINS};

static uint32_t bins_of(uint32_t level) {
    return (uint32_t)first_slot[level + 1u] - first_slot[level];
}

uint32_t spectrum_last_power(uint32_t level) {
    return bins_of(level) - 1u;
}

int32_t spectrum_mean_um_s2(const spectrum_t *self, uint32_t level) {
    return (int32_t)(self->sum[level] >> SPECTRUM_POINTS_LOG2(level));
}

void spectrum_init(spectrum_t *self, uint32_t slices) {
    *self = (spectrum_t){
        .slices = slices,
        .next_slice = slices,
        .power_level = SPECTRUM_LEVELS,
        .wanted_level = SPECTRUM_LEVELS,
    };
}

void spectrum_want_powers(spectrum_t *self, uint32_t level, int32_t constant_um_s2) {
    self->wanted_level = level;
    self->constant_um_s2 = constant_um_s2;
}

bool spectrum_start_round(spectrum_t *self, int32_t accel_um_s2) {
    const uint32_t newest = (self->newest + 1u) % SPECTRUM_RING;
    for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
        const uint32_t oldest = (newest - SPECTRUM_POINTS(level)) % SPECTRUM_RING;
        self->difference[level] = accel_um_s2 - self->sample[oldest];
        self->sum[level] += self->difference[level];
    }
    self->sample[newest] = accel_um_s2;
    self->newest = newest;
    self->next_slice = 0;
    self->power_level = self->wanted_level;
    self->wanted_level = SPECTRUM_LEVELS;
    return self->power_level < SPECTRUM_LEVELS;
}

// Table entries that one sample index is worth at bin 1 of a window.
static uint32_t stride_of(uint32_t level) {
    return COSINE_POINTS >> SPECTRUM_POINTS_LOG2(level);
}

// Slides bins first .. end-1 (bin numbers, from 1) of one window.
static void slide(spectrum_t *self, uint32_t level, uint32_t first, uint32_t end) {
    const uint32_t step = self->newest * stride_of(level);
    const int32_t gained = self->difference[level];
    const int32_t lost = -gained;
    spectrum_bin_t *bin = &self->bin[first_slot[level] + first - 1u];
    uint32_t angle = first * step;
    for (uint32_t k = first; k < end; k++) {
        bin->re += (int64_t)gained * cosine_q25[angle % COSINE_POINTS];
        bin->im += (int64_t)lost * cosine_q25[(angle - QUARTER) % COSINE_POINTS];
        bin++;
        angle += step;
    }
}

// A bin as an amplitude in um/s2.
typedef struct {
    int32_t re;
    int32_t im;
} phasor_t;

static phasor_t phasor(const spectrum_bin_t *bin, uint32_t level) {
    const uint32_t shift = 24u + SPECTRUM_POINTS_LOG2(level);
    return (phasor_t){(int32_t)(bin->re >> shift), (int32_t)(bin->im >> shift)};
}

// Bin 0, less the constant part that does not belong to the vibration.
static phasor_t constant_phasor(const spectrum_t *self, uint32_t level) {
    const int64_t rest = spectrum_mean_um_s2(self, level) - (int64_t)self->constant_um_s2;
    return (phasor_t){(int32_t)clamp_i64(2 * rest, -(1 << 30), 1 << 30), 0};
}

static int32_t high_word(int64_t value) {
    return (int32_t)(value >> 32);
}

// Power of bin k under the Hann window, which starts at the window's oldest sample: the two
// neighbours enter with half weight (the Q31 product's high word), turned by that sample's angle.
static uint64_t windowed_power(const spectrum_t *self, uint32_t level, uint32_t k) {
    const uint32_t angle = (self->newest + 1u) * stride_of(level);
    const int32_t cos_q31 = cosine_q25[angle % COSINE_POINTS] * 64;
    const int32_t sin_q31 = cosine_q25[(angle - QUARTER) % COSINE_POINTS] * 64;
    const spectrum_bin_t *bin = &self->bin[first_slot[level] + k - 1u];
    const phasor_t low = k == 1u ? constant_phasor(self, level) : phasor(bin - 1, level);
    const phasor_t mid = phasor(bin, level);
    const phasor_t high = phasor(bin + 1, level);
    const int32_t side_re =
        high_word((int64_t)(low.re + high.re) * cos_q31 + (int64_t)(low.im - high.im) * sin_q31);
    const int32_t side_im =
        high_word((int64_t)(low.im + high.im) * cos_q31 + (int64_t)(high.re - low.re) * sin_q31);
    const int32_t re = mid.re - side_re;
    const int32_t im = mid.im - side_im;
    return (uint64_t)((int64_t)re * re) + (uint64_t)((int64_t)im * im);
}

// Powers of the bins whose upper neighbour lies in first .. end-1.
static spectrum_span_t form_powers(spectrum_t *self, uint32_t level, uint32_t first, uint32_t end) {
    const uint32_t from = first < 2u ? 1u : first - 1u;
    const uint32_t to = end < 2u ? 1u : end - 1u;
    for (uint32_t k = from; k < to; k++) {
        self->power[k] = windowed_power(self, level, k);
    }
    return (spectrum_span_t){from, to};
}

spectrum_span_t spectrum_slice(spectrum_t *self) {
    spectrum_span_t span = {0, 0};
    if (self->next_slice == self->slices) {
        return span;
    }
    // An equal share of every window's bins.
    for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
        const uint32_t first = 1u + bins_of(level) * self->next_slice / self->slices;
        const uint32_t end = 1u + bins_of(level) * (self->next_slice + 1u) / self->slices;
        slide(self, level, first, end);
        if (level == self->power_level) {
            span = form_powers(self, level, first, end);
        }
    }
    self->next_slice++;
    return span;
}
