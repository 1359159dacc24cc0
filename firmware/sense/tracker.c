#include "tracker.h"

enum {
    LEAKAGE_RATIO = 20,   // amplitude, strongest peak over the weakest that counts
    STEADY_FRACTION = 32, // of the frequency, largest change between steady rounds
    DB_TO_LOG2_Q8 = 85,   // 256 / (10 log10(2)) for a power ratio in dB
};

void tracker_init(tracker_t *self, const tracker_cfg_t *cfg) {
    const uint64_t min_um_s2 = (uint32_t)cfg->min_accel_um_s2;
    *self = (tracker_t){
        .cfg = *cfg,
        .min_power = min_um_s2 * min_um_s2,
        .snr_log2_q8 = (uint32_t)cfg->snr_dB * DB_TO_LOG2_Q8,
        .age_ticks = UINT32_MAX,
    };
}

// Keeps the strongest candidates in order; a weaker one than all of a full list is dropped.
static void insert_candidate(tracker_t *self, const uint64_t *power, uint32_t k) {
    uint32_t slot = self->candidates;
    if (slot == TRACKER_CANDIDATES) {
        slot--;
        if (power[self->candidate[slot]] >= power[k]) {
            return;
        }
    } else {
        self->candidates++;
    }
    while (slot > 0 && power[self->candidate[slot - 1]] < power[k]) {
        self->candidate[slot] = self->candidate[slot - 1];
        slot--;
    }
    self->candidate[slot] = k;
}

void tracker_read(tracker_t *self, const uint64_t *power, uint32_t first, uint32_t end) {
    for (uint32_t k = first; k < end; k++) {
        if (k == TRACKER_FIRST_BIN) {
            self->log2_sum_q8 = 0;
            self->candidates = 0;
        }
        self->log2_sum_q8 += log2_q8_u64(power[k]);
        // The newest bin completes the neighbourhood of the one before it. The edges have none:
        // bin 1 stands against bin 2 alone, and what peaks at bin 52 lies beyond the band.
        const uint32_t centre = k - 1;
        if (centre >= TRACKER_FIRST_BIN && power[centre] > power[k] &&
            (centre == TRACKER_FIRST_BIN || power[centre] >= power[centre - 1])) {
            insert_candidate(self, power, centre);
        }
    }
}

// Frequency and amplitude of the peak at bin k from it and its larger neighbour.
static tracker_peak_t interpolate(const tracker_t *self, const uint64_t *power, uint32_t k) {
    const bool is_above = k == TRACKER_FIRST_BIN || power[k + 1] > power[k - 1];
    const uint64_t side_power = is_above ? power[k + 1] : power[k - 1];
    // Both roots share one scale, so that their ratio keeps 16 bits whatever the level.
    const uint32_t up = leading_zeros_u64(power[k]) & ~1u;
    const int32_t centre = (int32_t)isqrt_u32((uint32_t)((power[k] << up) >> 32));
    const int32_t side = (int32_t)isqrt_u32((uint32_t)((side_power << up) >> 32));
    const int32_t offset_q15 =
        clamp_i32((2 * side - centre) * 32768 / (side + centre), -8192, 16384);
    const int32_t bin_q15 = (int32_t)(k << 15) + (is_above ? offset_q15 : -offset_q15);
    const uint32_t shift = 15u + self->cfg.points_log2;
    // The main lobe falls to 0.849 half a bin from its middle, nearly as 1 - 0.61 d^2.
    const int32_t droop_q15 = (offset_q15 * offset_q15 >> 15) * 39 / 64;
    const int32_t gain_q15 = 32768 + droop_q15 + (droop_q15 * droop_q15 >> 15);
    const int64_t amp_um_s2 = ((int64_t)sqrt_fast_u64(power[k]) * gain_q15) >> 15;
    return (tracker_peak_t){
        .freq_uHz = (int32_t)((int64_t)bin_q15 * self->cfg.rate_uHz >> shift),
        .amp_um_s2 = (int32_t)clamp_i64(amp_um_s2, 0, INT32_MAX),
    };
}

static bool is_in_band(const tracker_t *self, int32_t freq_uHz) {
    return freq_uHz >= self->cfg.band_low_mHz * 1000 && freq_uHz <= self->cfg.band_high_mHz * 1000;
}

static bool is_significant(const tracker_t *self, const uint64_t *power, uint32_t k) {
    const uint32_t bins = TRACKER_LAST_BIN - TRACKER_FIRST_BIN + 1;
    const uint32_t floor_log2_q8 = self->log2_sum_q8 / bins;
    const uint64_t strongest = power[self->candidate[0]];
    return power[k] >= self->min_power && power[k] >= strongest / (LEAKAGE_RATIO * LEAKAGE_RATIO) &&
           log2_q8_u64(power[k]) >= floor_log2_q8 + self->snr_log2_q8;
}

// Whether a displaces more than b: amplitude / frequency^2, compared without a division.
static bool displaces_more(const tracker_peak_t *a, const tracker_peak_t *b) {
    const uint64_t a_mHz = (uint32_t)a->freq_uHz / 1000u;
    const uint64_t b_mHz = (uint32_t)b->freq_uHz / 1000u;
    return (uint32_t)a->amp_um_s2 * (b_mHz * b_mHz) > (uint32_t)b->amp_um_s2 * (a_mHz * a_mHz);
}

// Fills the reported peaks; returns the dominant one, 0 Hz where nothing counts.
static tracker_peak_t choose(tracker_t *self, const uint64_t *power) {
    tracker_peak_t best = {0};
    uint32_t reported = 0;
    for (uint32_t i = 0; i < TRACKER_PEAKS; i++) {
        self->peak[i] = (tracker_peak_t){0};
    }
    for (uint32_t i = 0; i < self->candidates; i++) {
        if (!is_significant(self, power, self->candidate[i])) {
            continue;
        }
        const tracker_peak_t peak = interpolate(self, power, self->candidate[i]);
        if (!is_in_band(self, peak.freq_uHz)) {
            continue;
        }
        if (reported < TRACKER_PEAKS) {
            self->peak[reported] = peak;
            reported++;
        }
        if (best.freq_uHz == 0 || displaces_more(&peak, &best)) {
            best = peak;
        }
    }
    return best;
}

void tracker_end_round(tracker_t *self, const uint64_t *power) {
    const tracker_peak_t best = choose(self, power);
    const int32_t change_uHz = abs_i32(best.freq_uHz - self->round_freq_uHz);
    const bool is_steady = best.freq_uHz != 0 && change_uHz <= best.freq_uHz / STEADY_FRACTION;
    self->steady_rounds = is_steady ? increment_sat_u32(self->steady_rounds) : 0;
    self->good_rounds = increment_sat_u32(self->good_rounds);
    self->round_freq_uHz = best.freq_uHz;
    self->is_valid = self->steady_rounds >= TRACKER_STEADY_ROUNDS &&
                     self->good_rounds >= self->cfg.window_rounds;
    if (self->is_valid) {
        self->dominant = best;
    }
}

void tracker_tick(tracker_t *self, bool is_input_good) {
    if (!is_input_good) {
        self->good_rounds = 0;
        self->is_valid = false;
    }
    self->age_ticks = self->is_valid ? 0 : increment_sat_u32(self->age_ticks);
}
