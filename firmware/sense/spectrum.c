#include "spectrum.h"

#include "cosine_table.h"

enum {
    QUARTER = COSINE_POINTS / 4,
    START_BINS = 6, // that the work of a new sample is worth, in the tick of the first slice
};

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

void spectrum_init(spectrum_t *self, uint32_t slices_log2) {
    *self = (spectrum_t){
        .slices_log2 = slices_log2,
        .next_slice = 1u << slices_log2,
        .power_level = SPECTRUM_LEVELS,
        .wanted_level = SPECTRUM_LEVELS,
    };
}

static void start_powers(spectrum_t *self) {
    self->power_level = self->wanted_level;
    self->wanted_level = SPECTRUM_LEVELS;
    self->power_round = 0;
}

void spectrum_want_powers(spectrum_t *self, uint32_t level, int32_t constant_um_s2) {
    self->wanted_level = level;
    self->constant_um_s2 = constant_um_s2;
    self->power_level = SPECTRUM_LEVELS;
    self->has_powers = false;
    if (self->next_slice == 0) {
        start_powers(self);
    }
}

void spectrum_start_round(spectrum_t *self, int32_t accel_um_s2) {
    const uint32_t newest = (self->newest + 1u) % SPECTRUM_RING;
    for (uint32_t level = 0; level < SPECTRUM_LEVELS; level++) {
        const uint32_t oldest = (newest - SPECTRUM_POINTS(level)) % SPECTRUM_RING;
        self->difference[level] = accel_um_s2 - self->sample[oldest];
        self->sum[level] += self->difference[level];
    }
    self->sample[newest] = accel_um_s2;
    self->newest = newest;
    self->next_slice = 0;
    if (self->wanted_level != SPECTRUM_LEVELS) {
        start_powers(self);
    }
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

static int32_t high_word(int64_t value) {
    return (int32_t)(value >> 32);
}

// 2^up of the high word: a tone's amplitude in every window, in steps of 2^up um/s2.
static phasor_t phasor(const spectrum_bin_t *bin, int32_t up) {
    return (phasor_t){high_word(bin->re) * up, high_word(bin->im) * up};
}

// Bin 0, less the constant part that does not belong to the vibration.
static phasor_t constant_phasor(const spectrum_t *self, uint32_t level) {
    const int64_t rest = spectrum_mean_um_s2(self, level) - (int64_t)self->constant_um_s2;
    return (phasor_t){(int32_t)clamp_i64(2 * rest, -(1 << 30), 1 << 30), 0};
}

// What the powers of a round have in common.
typedef struct {
    uint32_t level;
    int32_t up;      // of phasor()
    int32_t cos_q31; // angle of the window's oldest sample
    int32_t sin_q31;
} hann_t;

static hann_t hann_of(const spectrum_t *self, uint32_t level) {
    const uint32_t angle = (self->newest + 1u) * stride_of(level);
    return (hann_t){
        .level = level,
        .up = 1 << (8u - SPECTRUM_POINTS_LOG2(level)),
        .cos_q31 = cosine_q25[angle % COSINE_POINTS] * 64,
        .sin_q31 = cosine_q25[(angle - QUARTER) % COSINE_POINTS] * 64,
    };
}

// Power of bin k under the Hann window, which starts at the window's oldest sample: the two
// neighbours enter with half weight (the Q31 product's high word), turned by that sample's angle.
static uint64_t windowed_power(const spectrum_t *self, const hann_t *hann, uint32_t k) {
    const spectrum_bin_t *bin = &self->bin[first_slot[hann->level] + k - 1u];
    const phasor_t low = k == 1u ? constant_phasor(self, hann->level) : phasor(bin - 1, hann->up);
    const phasor_t mid = phasor(bin, hann->up);
    const phasor_t high = phasor(bin + 1, hann->up);
    const int32_t side_re = high_word((int64_t)(low.re + high.re) * hann->cos_q31 +
                                      (int64_t)(low.im - high.im) * hann->sin_q31);
    const int32_t side_im = high_word((int64_t)(low.im + high.im) * hann->cos_q31 +
                                      (int64_t)(high.re - low.re) * hann->sin_q31);
    const int32_t re = mid.re - side_re;
    const int32_t im = mid.im - side_im;
    return (uint64_t)((int64_t)re * re) + (uint64_t)((int64_t)im * im);
}

// Rounds that share a window's powers, so that they cost a tick no more than anything else.
static uint32_t power_rounds(uint32_t level) {
    return level == SPECTRUM_LONGEST ? 3u : level == SPECTRUM_LONGEST - 1u ? 2u : 1u;
}

// Powers of this round's bins whose upper neighbour lies in first .. end-1.
static void form_powers(spectrum_t *self, uint32_t first, uint32_t end) {
    const hann_t hann = hann_of(self, self->power_level);
    const uint32_t rounds = power_rounds(self->power_level);
    uint32_t k = first < 2u ? 1u : first - 1u;
    k += (self->power_round + rounds - k % rounds) % rounds;
    for (; k + 1u < end; k += rounds) {
        self->power[k] = windowed_power(self, &hann, k);
    }
}

static void end_round(spectrum_t *self) {
    if (self->power_level == SPECTRUM_LEVELS) {
        return;
    }
    self->power_round++;
    if (self->power_round == power_rounds(self->power_level)) {
        self->power_level = SPECTRUM_LEVELS;
        self->has_powers = true;
    }
}

// First slot of a slice: all do the same work, the first one that of the new sample too.
static uint32_t slot_of(const spectrum_t *self, uint32_t slice) {
    return slice == 0 ? 0
                      : ((SPECTRUM_BINS + START_BINS) * slice >> self->slices_log2) - START_BINS;
}

void spectrum_slice(spectrum_t *self) {
    const uint32_t slice = self->next_slice;
    if (slice >> self->slices_log2 != 0) {
        return;
    }
    uint32_t slot = slot_of(self, slice);
    const uint32_t end = slot_of(self, slice + 1u);
    for (uint32_t level = 0; slot < end; level++) {
        const uint32_t limit = first_slot[level + 1u] < end ? first_slot[level + 1u] : end;
        if (slot >= limit) {
            continue;
        }
        const uint32_t first = slot - first_slot[level] + 1u;
        slide(self, level, first, first + limit - slot);
        if (level == self->power_level) {
            form_powers(self, first, first + limit - slot);
        }
        slot = limit;
    }
    self->next_slice++;
    if (self->next_slice >> self->slices_log2 != 0) {
        end_round(self);
    }
}
