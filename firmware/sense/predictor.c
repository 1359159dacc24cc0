#include "predictor.h"

#define DIFFERENCE_LIMIT (1 << 27)

enum {
    TOLERANCE_SHIFT = 10, // of amplitude^2: 3 % of the amplitude
    NOISE_SHARE = 3,      // of the noise that each square is expected to exceed at most
    TOLERANCE_SHARE = 2,  // and of the tolerance
    NOISE_ALARM = 17,
    UNCLEAR_ALARM = 48, // where much is not explained, it is not white noise either
    TOLERANCE_ALARM = 4,
    OUTLIER = 8,        // of noise + tolerance: no square counts as more noise than this
    OFFSET_SHIFT = 6,   // the slow part: over 64 decimated samples (a quarter of a second)
    NOISE_SHIFT = 9,    // the noise: over 512 of the shortest blocks (a second)
    CALM_SCALE = 1,     // blocks of 8 ms ..
    CALM_BLOCKS = 5,    // .. in a row that fit again end a suspicion
    CALM_NOISE = 6,     // of the noise that the square of a fitting block does not exceed
    BURST_SHARE = 2048, // of the tolerance: squares of 2 ms that a burst may sum up to, 0.8 % of
                        // the longest window's energy
    SCALE_SHIFT = 2,    // a block of the next scale is four of this one
};

void predictor_init(predictor_t *self, uint32_t stages) {
    *self = (predictor_t){.stages = (uint8_t)stages};
}

static uint32_t block_shift(const predictor_t *self, uint32_t scale) {
    return self->stages - 1u + SCALE_SHIFT * scale;
}

// Blocks of the scale below (of the first one: ticks) that make one of this scale; at most 8.
static uint32_t block_parts(const predictor_t *self, uint32_t scale) {
    return 1u << (scale == 0 ? block_shift(self, 0) : SCALE_SHIFT);
}

static void arm(predictor_t *self) {
    for (uint32_t i = 0; i < PREDICTOR_SCALES; i++) {
        self->watch[i] = (predictor_watch_t){.left = block_parts(self, i)};
    }
    self->is_armed = true;
}

// No less noise than white noise of what the fit leaves: a watch that has just begun cannot know.
static void raise_noise(predictor_t *self, int32_t noise_um_s2) {
    const int64_t noise = clamp_i32(noise_um_s2, 0, DIFFERENCE_LIMIT);
    for (uint32_t i = 0; i < PREDICTOR_SCALES; i++) {
        const int64_t least = (2 * noise * noise) >> (SCALE_SHIFT * i);
        self->watch[i].noise = self->watch[i].noise > least ? self->watch[i].noise : least;
    }
}

void predictor_load(predictor_t *self, const predictor_tone_t *tones, uint32_t count,
                    const predictor_rest_t *rest) {
    int64_t square = 0;
    for (uint32_t i = 0; i < count; i++) {
        const int32_t amp = clamp_i32(tones[i].amp_um_s2, 0, DIFFERENCE_LIMIT);
        self->tone[i] = tones[i];
        square += (int64_t)amp * amp;
    }
    self->tones = count;
    const int64_t bend = clamp_i32(rest->bend_um_s2, 0, DIFFERENCE_LIMIT);
    self->tolerance = (square >> TOLERANCE_SHIFT) + bend * bend;
    self->noise_alarm = rest->is_clear ? NOISE_ALARM : UNCLEAR_ALARM;
    self->drift_um_s2_q8 = rest->drift_um_s2_q8;
    if (!self->is_armed || rest->bend_um_s2 != 0) {
        self->offset_q12 = (int64_t)rest->mean_um_s2 * (1 << 12);
    }
    if (!self->is_armed) {
        arm(self);
    }
    raise_noise(self, rest->noise_um_s2);
}

void predictor_disarm(predictor_t *self) {
    self->is_armed = false;
    self->is_suspicious = false;
}

static int32_t run_on(predictor_t *self) {
    int64_t sum_q25 = 0;
    for (uint32_t i = 0; i < self->tones; i++) {
        predictor_tone_t *tone = &self->tone[i];
        tone->phase_turn += tone->step_turn;
        sum_q25 += (int64_t)tone->amp_um_s2 * cos_linear_q25(tone->phase_turn);
    }
    const int64_t sum = sum_q25 >> 25;
    return (int32_t)clamp_i64((self->offset_q12 >> 12) + sum, -INT32_MAX, INT32_MAX);
}

// Mean square that a block's average may have by noise. Where noise is not white, a block of the
// next scale has more than a quarter of it left: then these blocks are not independent either.
static int64_t noise_of(const predictor_t *self, uint32_t scale) {
    const int64_t own = self->watch[scale].noise;
    if (scale + 1u == PREDICTOR_SCALES) {
        return own;
    }
    const int64_t slower = self->watch[scale + 1u].noise * (1 << SCALE_SHIFT);
    return own > slower ? own : slower;
}

// Page's sum after one more block's average. Returns true iff it says: changed.
static bool judge(predictor_t *self, uint32_t scale) {
    predictor_watch_t *at = &self->watch[scale];
    const int64_t noise = noise_of(self, scale);
    const int64_t square = at->average * at->average;
    at->sum += square - NOISE_SHARE * noise - TOLERANCE_SHARE * self->tolerance - 1;
    at->suspect_blocks++;
    if (at->sum <= 0) {
        at->sum = 0;
        at->suspect_blocks = 0;
    }
    const int64_t most = OUTLIER * (at->noise + self->tolerance + 1);
    at->noise +=
        ((square < most ? square : most) - at->noise) >> (NOISE_SHIFT - SCALE_SHIFT * scale);
    return at->sum > self->noise_alarm * noise + TOLERANCE_ALARM * self->tolerance;
}

// Sums blocks: a finished one of a scale is a part of the next scale's.
static void collect(predictor_t *self, int64_t difference) {
    int64_t part = difference;
    for (uint32_t i = 0; i < PREDICTOR_SCALES; i++) {
        predictor_watch_t *at = &self->watch[i];
        at->open += part;
        at->left--;
        if (at->left != 0) {
            break;
        }
        part = at->open;
        at->open = 0;
        at->left = block_parts(self, i);
        at->average = part >> block_shift(self, i);
        at->is_due = true;
    }
}

// Judges one finished block a tick, the shortest first; the others can wait for a tick in which it
// does not end (where every tick ends one, two are judged).
static bool watch(predictor_t *self) {
    bool has_changed = false;
    const uint32_t most = block_parts(self, 0) == 1u ? 2u : 1u;
    uint32_t judged = 0;
    for (uint32_t i = 0; i < PREDICTOR_SCALES && judged < most; i++) {
        predictor_watch_t *at = &self->watch[i];
        if (!at->is_due) {
            continue;
        }
        at->is_due = false;
        judged++;
        if (judge(self, i) && !has_changed) {
            has_changed = true;
            // The block in which it began may still hold some of what was before.
            self->suspect_ticks = (at->suspect_blocks - 1u) << block_shift(self, i);
        }
    }
    return has_changed;
}

static void suspect(predictor_t *self) {
    self->is_suspicious = true;
    self->calm_blocks = 0;
    self->burst = self->watch[0].sum / BURST_SHARE;
    for (uint32_t i = 0; i < PREDICTOR_SCALES; i++) {
        self->watch[i].sum = 0;
        self->watch[i].suspect_blocks = 0;
        self->watch[i].is_due = false;
    }
}

// Whether the samples fit again after a burst so small that the windows bear it.
static bool is_back(predictor_t *self) {
    predictor_watch_t *shortest = &self->watch[0];
    if (shortest->is_due && self->burst <= self->tolerance) { // else it is too large for good
        self->burst += shortest->average * shortest->average / BURST_SHARE;
    }
    shortest->is_due = false;
    predictor_watch_t *at = &self->watch[CALM_SCALE];
    if (at->is_due) {
        at->is_due = false;
        const int64_t most = CALM_NOISE * at->noise + TOLERANCE_SHARE * self->tolerance;
        self->calm_blocks = at->average * at->average <= most ? self->calm_blocks + 1u : 0;
    }
    return self->calm_blocks >= CALM_BLOCKS && self->burst <= self->tolerance;
}

predictor_verdict_t predictor_step(predictor_t *self, int32_t accel_um_s2, bool is_good) {
    self->prediction_um_s2 = run_on(self);
    if (!self->is_armed || !is_good) {
        return PREDICTOR_FITS;
    }
    const int64_t error = (int64_t)accel_um_s2 - self->prediction_um_s2;
    const int64_t difference = clamp_i64(error, -DIFFERENCE_LIMIT, DIFFERENCE_LIMIT);
    collect(self, difference);
    if (self->is_suspicious) {
        self->is_suspicious = !is_back(self);
        return self->is_suspicious ? PREDICTOR_FITS : PREDICTOR_BACK;
    }
    self->offset_q12 += (int64_t)self->drift_um_s2_q8 * 16;
    self->offset_q12 += (difference * (1 << 12)) >> (OFFSET_SHIFT + self->stages);
    if (!watch(self)) {
        return PREDICTOR_FITS;
    }
    suspect(self);
    return PREDICTOR_CHANGED;
}
