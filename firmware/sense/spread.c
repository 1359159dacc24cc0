#include "spread.h"

enum {
    RATE_mHz = 250000,
    FAR = 2,              // times the largest mean frequency
    FAR_MOST_mHz = 20000, // of which that is beyond all that is read
    FIRST_BIN = 2,        // the Hann window shows a constant part in the one below, too
    HEAD_ROOM = 8,        // bits: sums of 2^6 powers below 2^61 fit 64
    MEMORY_LOG2 = 5,      // spectra
    LEAST_SPECTRA = 16,
    // (v/x)^2 / (a/v)^2, Q8: .68 squared makes a band narrow, .64 squared lets it be.
    NARROW_Q8 = 118,
    STILL_NARROW_Q8 = 105,
};

static uint32_t bins_q8(int32_t freq_mHz) {
    return ((uint32_t)freq_mHz << (SPREAD_POINTS_LOG2 + 8u)) / RATE_mHz;
}

// Square of a frequency in bins, Q8.
static uint32_t square_q8(int32_t freq_mHz) {
    const uint32_t k_q8 = bins_q8(freq_mHz);
    return (k_q8 * k_q8) >> 8;
}

void spread_init(spread_t *self, const spread_cfg_t *cfg) {
    const int32_t high_mHz = cfg->high_mHz < FAR_MOST_mHz ? cfg->high_mHz : FAR_MOST_mHz;
    *self = (spread_t){
        .least_um_s2 = (uint32_t)cfg->least_um_s2,
        .low_k2_q8 = square_q8(cfg->low_mHz),
        .high_k2_q8 = square_q8(cfg->high_mHz),
        .far_bin = (uint8_t)((FAR * bins_q8(high_mHz) + 128u) >> 8),
    };
}

void spread_forget(spread_t *self) {
    self->spectra = 0;
    self->is_narrow = false;
}

static void take_in(spread_t *self, const uint64_t sum[3]) {
    // The first one is the mean, the second half of it, .. (31 - clz is the log2.)
    const uint32_t log2 = 31u - (uint32_t)__builtin_clz(self->spectra + 1u);
    const uint32_t part = log2 < MEMORY_LOG2 ? log2 : MEMORY_LOG2;
    for (uint32_t i = 0; i < 3u; i++) {
        self->mean[i] += (sum[i] >> part) - (self->mean[i] >> part);
    }
    if (self->spectra < UINT8_MAX) {
        self->spectra++;
    }
}

// Of a tone's A^2 the Hann bins hold 1.5, its mean square is a half. What is narrow keeps it with
// half.
static bool is_strong(const spread_t *self) {
    const uint64_t least_um_s2 = self->least_um_s2;
    const uint64_t least = (3u * least_um_s2 * least_um_s2) >> HEAD_ROOM;
    return self->mean[0] >= (self->is_narrow ? least / 2u : least);
}

// Whether it is so; what is so already stays so a little longer.
static bool is_narrow_now(const spread_t *self) {
    const uint32_t least_q8 = self->is_narrow ? STILL_NARROW_Q8 : NARROW_Q8;
    if (self->spectra < LEAST_SPECTRA || self->mean[0] == 0 || !is_strong(self)) {
        return false;
    }
    // All of them below 2^31: the smallest, of a bin 52 or less, keeps 8 bits.
    const uint32_t zeros = leading_zeros_u64(self->mean[0]);
    const uint32_t down = zeros < 33u ? 33u - zeros : 0u;
    const uint64_t accel = self->mean[0] >> down;
    const uint64_t velocity = self->mean[1] >> down;
    const uint64_t displacement = self->mean[2] >> down;
    return velocity << 8 >= displacement * self->low_k2_q8 &&
           accel << 8 <= velocity * self->high_k2_q8 &&
           velocity * velocity >= (accel * displacement >> 8) * least_q8;
}

void spread_take(spread_t *self, const uint64_t *power, uint32_t first_bin, uint32_t end_bin) {
    uint64_t sum[3] = {0};
    for (uint32_t k = first_bin > FIRST_BIN ? first_bin : FIRST_BIN; k < end_bin; k++) {
        uint64_t part = power[k] >> HEAD_ROOM;
        const uint32_t sums = k < self->far_bin ? 3u : 1u;
        for (uint32_t i = 0; i < sums; i++) {
            sum[i] += part;
            part = over_square(part, k);
        }
    }
    take_in(self, sum);
    self->is_narrow = is_narrow_now(self);
}
