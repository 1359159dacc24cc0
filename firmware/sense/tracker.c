#include "tracker.h"

enum {
    LEAKAGE_RATIO = 20,       // amplitude, strongest peak over the weakest that counts
    DB_TO_LOG2_Q8 = 85,       // 256 / (10 log10(2)) for a power ratio in dB
    AGREE_FRACTION = 32,      // of the frequency, largest change between agreeing fits
    SIGMA_FRACTION = 64,      // of the frequency, largest standard deviation
    FLOOR_TO_LIMIT_Q8 = -150, // (0.83 + 1.17 - log2(6)) x 256
    LONGEST = 3,              // index of the longest window
    MISSED_FITS = 2,          // that end it
    BAND_EDGE_uHz = 20000,    // noise of an estimate right at the edge
};

// Share of the energy that a fit must explain to be clear, Q16: 98, 97 and 92 %, and 85 % in the
// longest window; more noise would hide a change for too long.
static const uint16_t least_explained_q16[] = {64300, 63600, 60300, 55700};

void tracker_init(tracker_t *self, const tracker_cfg_t *cfg) {
    const uint64_t min_um_s2 = (uint32_t)cfg->min_accel_um_s2;
    *self = (tracker_t){
        .cfg = *cfg,
        .min_power = min_um_s2 * min_um_s2,
        .snr_log2_q8 = (uint32_t)cfg->snr_dB * DB_TO_LOG2_Q8,
    };
}

void tracker_reset(tracker_t *self) {
    self->tones = 0;
    self->in_band = 0;
    self->misses = 0;
    self->is_valid = false;
}

void tracker_start_search(tracker_t *self, const tracker_window_t *window) {
    self->window = *window;
    self->log2_sum_q8[0] = 0;
    self->log2_sum_q8[1] = 0;
    self->candidates = 0;
    self->height = 0;
    self->is_rising = false;
    self->next = 0;
    self->starts = 0;
    self->strongest_um_s2 = 0;
    self->has_drift = false;
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
        self->log2_sum_q8[2u * k > self->window.last_power] += log2_q8_u64(power[k]);
        // Rising with the frequency, so that a drift's flank does not hide what stands on it. The
        // newest bin completes the neighbourhood of the one before it; bin 1 stands against bin 2
        // alone, and what peaks at the last one lies beyond the band.
        const uint64_t height = (power[k] >> 12) * (k * k);
        if (self->is_rising && height < self->height) {
            insert_candidate(self, power, k - 1u);
        }
        self->is_rising = height > self->height;
        self->height = height;
    }
}

// Frequency in bins, Q15, of the peak at bin k, from it and its larger neighbour.
static int32_t interpolate_q15(const uint64_t *power, uint32_t k) {
    const bool is_above = k == 1u || power[k + 1] > power[k - 1];
    const uint64_t side_power = is_above ? power[k + 1] : power[k - 1];
    // Both roots share one scale, so that their ratio keeps 16 bits whatever the level.
    const uint32_t up = leading_zeros_u64(power[k] | side_power | 1u) & ~1u;
    const int32_t centre = (int32_t)isqrt_u32((uint32_t)((power[k] << up) >> 32));
    const int32_t side = (int32_t)isqrt_u32((uint32_t)((side_power << up) >> 32));
    // Half the numerator and denominator: 31 bits.
    const int32_t offset_q15 =
        clamp_i32((2 * side - centre) / 2 * 32768 / ((side + centre) / 2 + 1), -8192, 32768);
    return (int32_t)(k << 15) + (is_above ? offset_q15 : -offset_q15);
}

static bool is_significant(const tracker_t *self, const uint64_t *power, uint32_t k) {
    const uint64_t strongest = power[self->candidate[0]];
    if (power[k] < self->min_power || power[k] < strongest / (LEAKAGE_RATIO * LEAKAGE_RATIO)) {
        return false;
    }
    const uint32_t floor_log2_q8 =
        (self->log2_sum_q8[0] + self->log2_sum_q8[1]) / self->window.last_power;
    return !self->window.is_longest || log2_q8_u64(power[k]) >= floor_log2_q8 + self->snr_log2_q8;
}

// A bin in turns a sample, Q32, by points_log2.
static uint32_t bin_turn(const tracker_t *self) {
    return 1u << (32u - self->window.points_log2);
}

bool tracker_is_drift(const tracker_t *self, uint32_t turn) {
    return turn < bin_turn(self) - bin_turn(self) / 8u;
}

bool tracker_is_missing_something(const tracker_t *self, int32_t residual_um_s2) {
    // White noise of variance s^2 makes Hann powers of 6 s^2 / N on average; the mean of their
    // logarithms lies 0.83 below the logarithm of that. 1.5 times the deviation is 1.17 more.
    const uint64_t variance = (uint64_t)(uint32_t)residual_um_s2 * (uint32_t)residual_um_s2;
    // The half of the spectrum with less in it knows the noise better.
    const uint32_t below = self->window.last_power / 2u;
    const uint32_t low_q8 = self->log2_sum_q8[0] / below;
    const uint32_t high_q8 = self->log2_sum_q8[1] / (self->window.last_power - below);
    const int32_t floor_log2_q8 = (int32_t)(low_q8 < high_q8 ? low_q8 : high_q8);
    const int32_t limit_q8 =
        floor_log2_q8 + (int32_t)(self->window.points_log2 << 8) + FLOOR_TO_LIMIT_Q8;
    return self->window.is_longest && (int32_t)log2_q8_u64(variance) > limit_q8;
}

// The last fit's frequency where it belongs to this candidate, else the candidate's own. A fit from
// before a reset is a hint only.
static uint32_t start_turn(const tracker_t *self, int32_t bin_q15) {
    const uint32_t turn = (uint32_t)bin_q15 << (17u - self->window.points_log2);
    const uint32_t gate = self->tones > 0 ? bin_turn(self) : bin_turn(self) / 4u;
    for (uint32_t i = 0; i < self->hints; i++) {
        if (gap_u32(turn, self->tone[i].turn) < gate) {
            return self->tone[i].turn;
        }
    }
    return turn;
}

static bool is_in_band(const tracker_t *self, int32_t freq_uHz) {
    return freq_uHz >= self->cfg.band_low_mHz * 1000 - BAND_EDGE_uHz &&
           freq_uHz <= self->cfg.band_high_mHz * 1000 + BAND_EDGE_uHz;
}

// Whether a, at frequency fa, displaces more than b at fb: amplitude / frequency^2, without a
// division. Frequencies in any one unit up to 16 bits.
static bool displaces_more(uint32_t amp_a, uint32_t fa, uint32_t amp_b, uint32_t fb) {
    return (uint64_t)amp_a * (fb * fb) > (uint64_t)amp_b * (fa * fa);
}

// Index of the one with the largest displacement; count > 0.
__attribute__((noinline)) static uint32_t farthest_of(const tracker_start_t *start,
                                                      uint32_t count) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < count; i++) {
        if (displaces_more(start[i].amp, start[i].turn >> 16, start[best].amp,
                           start[best].turn >> 16)) {
            best = i;
        }
    }
    return best;
}

// Puts the one with the largest displacement first; the others keep their order.
static void farthest_start_first(tracker_start_t *start, uint32_t count) {
    if (count == 0) {
        return;
    }
    uint32_t best = farthest_of(start, count);
    const tracker_start_t first = start[best];
    for (; best > 0; best--) {
        start[best] = start[best - 1];
    }
    start[0] = first;
}

// Whether a start within a bin of it stands already.
static bool is_close(const tracker_t *self, uint32_t turn) {
    for (uint32_t i = 0; i < self->starts; i++) {
        if (gap_u32(turn, self->start[i].turn) < bin_turn(self)) {
            return true;
        }
    }
    return false;
}

// Components of the last fit stay in, even where the spectrum does not show a peak of their own.
static void add_known(tracker_t *self) {
    for (uint32_t i = 0; i < self->tones && self->starts < TRACKER_CANDIDATES; i++) {
        const tracker_tone_t *tone = &self->tone[i];
        if (!is_close(self, tone->turn)) {
            self->start[self->starts] = (tracker_start_t){tone->turn, (uint32_t)tone->amp_um_s2};
            self->starts++;
        }
    }
}

static void take_candidate(tracker_t *self, const uint64_t *power, uint32_t k) {
    if (!is_significant(self, power, k)) {
        return;
    }
    const uint32_t turn = start_turn(self, interpolate_q15(power, k));
    if (tracker_is_drift(self, turn)) {
        self->has_drift |= self->window.is_longest;
    } else if (!is_close(self, turn)) {
        const uint32_t amp = sqrt_fast_u64(power[k]);
        self->start[self->starts] = (tracker_start_t){turn, amp};
        self->strongest_um_s2 = amp > self->strongest_um_s2 ? amp : self->strongest_um_s2;
        self->starts++;
    }
}

bool tracker_choose(tracker_t *self, const uint64_t *power) {
    const uint32_t before = self->starts;
    while (self->next < self->candidates && self->starts == before) {
        take_candidate(self, power, self->candidate[self->next]);
        self->next++;
    }
    if (self->next < self->candidates) {
        return false;
    }
    if (self->window.is_longest) {
        add_known(self);
        farthest_start_first(self->start, self->starts);
    }
    // A window of n samples tells about log2(n) - 4 components apart.
    const uint32_t most = self->window.points_log2 - 4u;
    self->starts = self->starts < most ? self->starts : most;
    self->starts = self->starts < TRACKER_TONES ? self->starts : TRACKER_TONES;
    return true;
}

// A sticking damper's third harmonic displaces less than what it belongs to.
static bool is_third_harmonic(const tracker_t *self, const tracker_start_t *of,
                              const tracker_start_t *tone) {
    return gap_u32(3u * of->turn, tone->turn) < bin_turn(self) / 8u && of->amp >= tone->amp / 9u;
}

// Index of the one that holds nine sixteenths of the energy of all, or half of it where it was the
// dominant one before; count: there is none.
static uint32_t strongest_of(const tracker_t *self, const tracker_start_t *tone, uint32_t count,
                             uint32_t turn_before) {
    uint64_t energy = 0;
    uint64_t most = 0;
    uint32_t best = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t own = (uint64_t)tone[i].amp * tone[i].amp;
        energy += own;
        best = own > most ? i : best;
        most = own > most ? own : most;
    }
    const bool is_known = gap_u32(tone[best].turn, turn_before) < bin_turn(self) / 2u;
    return most >= energy / 2u + (is_known ? 0 : energy / 16u) ? best : count;
}

// Index of the dominant one among the first tones, which are in the band; count > 0.
static uint32_t dominant_of(const tracker_t *self, uint32_t count, uint32_t turn_before) {
    tracker_start_t tone[TRACKER_TONES];
    for (uint32_t i = 0; i < count; i++) {
        tone[i] = (tracker_start_t){self->tone[i].turn, (uint32_t)self->tone[i].amp_um_s2};
    }
    uint32_t best = strongest_of(self, tone, count, turn_before);
    best = best < count ? best : farthest_of(tone, count);
    for (uint32_t i = 0; i < count; i++) {
        if (is_third_harmonic(self, &tone[i], &tone[best])) {
            return i;
        }
    }
    return best;
}

// Whether a fitted tone stands out of what the fit leaves: a bin's power over the noise's.
static bool stands_out(const tracker_t *self, int32_t amp_um_s2, int32_t residual_um_s2) {
    const uint64_t signal = ((uint64_t)(uint32_t)amp_um_s2 * (uint32_t)amp_um_s2) / 4u;
    const uint64_t noise = (uint64_t)(uint32_t)residual_um_s2 * (uint32_t)residual_um_s2;
    return log2_q8_u64(signal) + (self->window.points_log2 << 8) >=
           log2_q8_u64(noise) + self->snr_log2_q8;
}

__attribute__((noinline)) static void swap(tracker_tone_t *a, tracker_tone_t *b) {
    const tracker_tone_t first = *a;
    *a = *b;
    *b = first;
}

// Keeps the fitted tones that stand out; those in the band first, the dominant one before all.
static void keep(tracker_t *self, const tracker_tone_t *tones, uint32_t count,
                 int32_t residual_um_s2) {
    const uint32_t turn_before = self->hints > 0 ? self->tone[0].turn : 0;
    self->tones = 0;
    self->in_band = 0;
    for (uint32_t i = 0; i < count; i++) {
        tracker_tone_t *tone = &self->tone[self->tones];
        if (!stands_out(self, tones[i].amp_um_s2, residual_um_s2)) {
            continue;
        }
        *tone = tones[i];
        tone->freq_uHz = tracker_freq_uHz(tone->turn);
        self->tones++;
        if (is_in_band(self, tone->freq_uHz)) {
            tone->freq_uHz = clamp_i32(tone->freq_uHz, self->cfg.band_low_mHz * 1000,
                                       self->cfg.band_high_mHz * 1000);
            swap(tone, &self->tone[self->in_band]);
            self->in_band++;
        }
    }
    self->hints = self->tones;
    if (self->in_band > 0) {
        swap(&self->tone[dominant_of(self, self->in_band, turn_before)], &self->tone[0]);
    }
}

static bool is_explained(const tracker_t *self, uint32_t explained_q16) {
    const uint32_t level = self->window.is_longest ? LONGEST : self->window.points_log2 - 5u;
    return explained_q16 >= least_explained_q16[level];
}

// Whether the fit holds; in a short window it must be clear, too.
static bool qualifies(const tracker_t *self, uint32_t explained_q16) {
    if (self->in_band == 0) {
        return false;
    }
    const tracker_tone_t *tone = &self->tone[0];
    // A short window must hold 1.25 cycles, the longest one 7/8.
    const uint32_t bin = bin_turn(self);
    const uint32_t least = self->window.is_longest ? bin - bin / 8u : bin + bin / 4u;
    return abs_i32(tone->shift_q29) <= TRACKER_CONVERGED_Q29 && tone->turn >= least &&
           tone->sigma_turn <= tone->turn / SIGMA_FRACTION &&
           (self->window.is_longest || is_explained(self, explained_q16));
}

bool tracker_decide(tracker_t *self, const tracker_tone_t *tones, uint32_t count,
                    int32_t residual_um_s2, uint32_t explained_q16) {
    keep(self, tones, count, residual_um_s2);
    const bool is_good = qualifies(self, explained_q16);
    self->misses = is_good ? 0 : increment_sat_u32(self->misses);
    self->is_clear = is_explained(self, explained_q16);
    if (is_good) {
        self->is_valid = true;
    } else if (self->misses >= MISSED_FITS) {
        self->is_valid = false;
    }
    return is_good;
}
