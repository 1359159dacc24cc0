#include "tone_fit.h"

#define HALF_PI_Q16 INT64_C(102944)
#define ONE_Q30 INT32_C(1073741824)
#define RADIANS_LIMIT_Q29 843314856 // pi / 2: half a bin

enum {
    DATA_BITS = 22,
    SPARE_BITS = 3,
    SUM_BITS = 24,         // fraction of cosines and sines in the sums
    RIGHT_BITS = 8,        // of the right sides, above the data's unit
    PAIRS_A_COUPLING = 24, // what one coupling costs, in pairs of samples
};

static uint32_t points_of(const tone_fit_t *self) {
    return 1u << self->window.points_log2;
}

static uint32_t pairs_of(const tone_fit_t *self) {
    return points_of(self) / 2u;
}

static void enter(tone_fit_t *self, tone_fit_stage_t stage) {
    self->stage = stage;
    self->done = 0;
}

static uint32_t end_of_slice(const tone_fit_t *self, uint32_t pairs) {
    const uint32_t left = pairs_of(self) - self->done;
    return self->done + (pairs < left ? pairs : left);
}

// value x 2^up_shift; what leaves the word is noticed afterwards (has_right_scale).
static int32_t scaled(int32_t value, int32_t up_shift) {
    return up_shift >= 0 ? (int32_t)((uint32_t)value << up_shift) : value >> -up_shift;
}

static uint32_t magnitude_bits(int32_t value) {
    return value < 0 ? ~(uint32_t)value : (uint32_t)value;
}

// Folds the window about its middle. |x| < 2^29, so that the folded ones fit 32 bits.
static void gather(tone_fit_t *self, uint32_t pairs) {
    const tone_fit_window_t *w = &self->window;
    const uint32_t end = end_of_slice(self, pairs);
    const uint32_t right = w->newest - pairs_of(self) + 1u;
    uint32_t bits = self->bits;
    uint64_t energy = self->energy;
    for (uint32_t i = self->done; i < end; i++) {
        const int32_t ahead = w->ring[(right + i) & w->ring_mask] - w->mean_um_s2;
        const int32_t behind = w->ring[(right - 1u - i) & w->ring_mask] - w->mean_um_s2;
        const int32_t even = scaled(ahead + behind, self->up_shift);
        const int32_t odd = scaled(ahead - behind, self->up_shift);
        bits |= magnitude_bits(ahead + behind) | magnitude_bits(ahead - behind);
        self->even[i] = even;
        self->odd[i] = odd;
        energy += (uint64_t)((int64_t)even * even) + (uint64_t)((int64_t)odd * odd);
        self->constant += even;
    }
    self->bits = bits;
    self->energy = energy;
    self->done = end;
}

static void start_gathering(tone_fit_t *self) {
    self->bits = 0;
    self->energy = 0;
    self->constant = 0;
    enter(self, TONE_FIT_GATHER);
}

// That makes DATA_BITS of a size.
static int32_t best_shift(uint32_t size) {
    return size == 0 ? 0 : DATA_BITS - (32 - __builtin_clz(size));
}

// Whether the data came out with DATA_BITS or a few less; sets the right scale otherwise.
static bool has_right_scale(tone_fit_t *self) {
    const int32_t best = best_shift(self->bits);
    const bool is_right = self->up_shift <= best && self->up_shift >= best - SPARE_BITS;
    self->up_shift = is_right ? self->up_shift : best;
    return is_right;
}

void tone_fit_init(tone_fit_t *self) {
    *self = (tone_fit_t){.stage = TONE_FIT_IDLE};
}

void tone_fit_start(tone_fit_t *self, const tone_fit_window_t *window) {
    self->window = *window;
    self->slots = 0;
    self->up_shift = best_shift(window->size_um_s2);
    start_gathering(self);
}

static int32_t to_i32(int64_t value) {
    return (int32_t)clamp_i64(value, -INT32_MAX, INT32_MAX);
}

static void start_projection(tone_fit_t *self) {
    const uint32_t turn = self->tone[self->slot].turn;
    const sincos_t half = sincos_q30(turn / 2u);
    const sincos_t step = sincos_q30(turn);
    self->turn_cos_q30 = half.cos;
    self->turn_sin_q30 = half.sin;
    self->step_cos_q30 = step.cos;
    self->step_sin_q30 = step.sin;
    self->sums = (tone_fit_sums_t){0};
    enter(self, TONE_FIT_PROJECT);
}

void tone_fit_set(tone_fit_t *self, const uint32_t *turns, uint32_t count, bool has_drift) {
    for (uint32_t i = 0; i < count; i++) {
        self->tone[i].turn = turns[i];
    }
    self->tones = count;
    self->slots = count;
    if (has_drift) {
        self->tone[count].turn = UINT32_C(0x80000000) >> self->window.points_log2;
        self->slots++;
    }
    self->slot = 0;
    ldlt_start(&self->even_half, 1u + 2u * self->slots);
    ldlt_start(&self->odd_half, 2u * self->slots);
    self->even_half.matrix[0] = ONE_Q30;
    self->even_half.right[0] =
        to_i32((self->constant * (1 << RIGHT_BITS)) >> self->window.points_log2);
    start_projection(self);
}

// A rotation by the step; the two lost bits a product are 2^-28, their sum over a window 10^-7.
static int32_t rotated(int64_t sum_q60) {
    return (int32_t)(sum_q60 >> 32) * 4;
}

static void project(tone_fit_t *self, uint32_t pairs) {
    const uint32_t end = end_of_slice(self, pairs);
    const int32_t step_cos = self->step_cos_q30;
    const int32_t step_sin = self->step_sin_q30;
    int32_t c = self->turn_cos_q30;
    int32_t s = self->turn_sin_q30;
    tone_fit_sums_t sums = self->sums;
    for (uint32_t i = self->done; i < end; i++) {
        const int32_t weight = (int32_t)(2u * i + 1u); // twice the distance from the middle
        const int32_t c_q24 = c >> 6;
        const int32_t s_q24 = s >> 6;
        const int32_t even = self->even[i];
        const int32_t odd = self->odd[i];
        sums.even_cos += (int64_t)even * c_q24;
        sums.even_slope_sin += (int64_t)(weight * even) * s_q24;
        sums.odd_sin += (int64_t)odd * s_q24;
        sums.odd_slope_cos += (int64_t)(weight * odd) * c_q24;
        const int32_t next = rotated((int64_t)c * step_cos - (int64_t)s * step_sin);
        s = rotated((int64_t)s * step_cos + (int64_t)c * step_sin);
        c = next;
    }
    self->turn_cos_q30 = c;
    self->turn_sin_q30 = s;
    self->sums = sums;
    self->done = end;
}

// Rows of a component's unknowns in the even and the odd half.
static uint32_t even_row(uint32_t slot) {
    return 1u + 2u * slot;
}
static uint32_t odd_row(uint32_t slot) {
    return 2u * slot;
}

static void keep_projection(tone_fit_t *self) {
    // Means over the window; the slope's weight is 2 m / N.
    const uint32_t plain = SUM_BITS - RIGHT_BITS + self->window.points_log2;
    const uint32_t slope = plain + self->window.points_log2;
    int32_t *even = &self->even_half.right[even_row(self->slot)];
    int32_t *odd = &self->odd_half.right[odd_row(self->slot)];
    even[0] = to_i32(self->sums.even_cos >> plain);
    even[1] = to_i32(self->sums.even_slope_sin >> slope);
    odd[0] = to_i32(self->sums.odd_sin >> plain);
    odd[1] = to_i32(self->sums.odd_slope_cos >> slope);
}

// Means over the window, Q30: cos(t m), u sin(t m), u^2 cos(t m).
typedef struct {
    int32_t d0;
    int32_t d1;
    int32_t d2;
} kernel_t;

static int32_t times_q30(int32_t a, int32_t b) {
    return (int32_t)(((int64_t)a * b) >> 30);
}

// 1 / (N sine) in Q30, sine Q30 > 0: 0.64 for t of half a cycle a window.
static int32_t over_points(int32_t sine_q30, uint32_t points_log2) {
    const uint32_t zeros = (uint32_t)__builtin_clz((uint32_t)sine_q30 | 1u);
    const uint32_t inverse = reciprocal_u32(((uint32_t)sine_q30 | 1u) << zeros);
    const int32_t down = 3 + (int32_t)points_log2 - (int32_t)zeros;
    const uint32_t g_q30 = down > 0 ? inverse >> down : (uint32_t)INT32_MAX;
    return g_q30 > (uint32_t)INT32_MAX ? INT32_MAX : (int32_t)g_q30;
}

// t in turns a sample, t = 0 or about half a cycle a window and more. Closed sums: d0 = sin(N t/2)
// / (N sin(t/2)), d1 and d2 from its derivatives.
static kernel_t kernel(uint32_t t, uint32_t points_log2) {
    const int32_t one_less = ONE_Q30 - (ONE_Q30 >> (2u * points_log2)); // 1 - 1/N^2
    if (t == 0) {
        return (kernel_t){ONE_Q30, 0, one_less / 3};
    }
    const sincos_t half = sincos_q30(t / 2u);
    const sincos_t edge = sincos_q30((t / 2u) << points_log2);
    const int32_t g_q30 = over_points(half.sin, points_log2);
    const int32_t d0 = times_q30(edge.sin, g_q30);
    const int32_t d1 = times_q30(times_q30(half.cos, d0) - edge.cos, g_q30);
    const int64_t twice_q30 = 2 * (int64_t)times_q30(times_q30(half.cos, d1), g_q30);
    const int32_t d2 =
        (int32_t)clamp_i64(times_q30(one_less, d0) - twice_q30, -INT32_MAX, INT32_MAX);
    return (kernel_t){d0, d1, d2};
}

// Half of the sum of two kernels.
static void put(ldlt_t *half, uint32_t row, uint32_t column, int32_t one, int32_t other) {
    half->matrix[ldlt_index(row, column)] = (int32_t)(((int64_t)one + other) >> 1);
}

// Entries of component i against component j <= i, from the kernels at the sum and the difference.
static void couple(tone_fit_t *self, uint32_t i, uint32_t j) {
    const uint32_t log2 = self->window.points_log2;
    const uint32_t wi = self->tone[i].turn;
    const uint32_t wj = self->tone[j].turn;
    const kernel_t sum = kernel(wi + wj, log2);
    kernel_t gap = kernel(wi > wj ? wi - wj : wj - wi, log2);
    gap.d1 = wi > wj ? gap.d1 : -gap.d1; // at wi - wj
    const uint32_t ei = even_row(i);
    const uint32_t ej = even_row(j);
    const uint32_t oi = odd_row(i);
    const uint32_t oj = odd_row(j);
    put(&self->even_half, ei, ej, gap.d0, sum.d0);
    put(&self->even_half, ei + 1u, ej, sum.d1, gap.d1);
    put(&self->even_half, ei + 1u, ej + 1u, gap.d2, -sum.d2);
    put(&self->odd_half, oi, oj, gap.d0, -sum.d0);
    put(&self->odd_half, oi + 1u, oj, sum.d1, -gap.d1);
    put(&self->odd_half, oi + 1u, oj + 1u, gap.d2, sum.d2);
    if (i != j) {
        put(&self->even_half, ei, ej + 1u, sum.d1, -gap.d1);
        put(&self->odd_half, oi, oj + 1u, sum.d1, gap.d1);
    }
}

static void couple_constant(tone_fit_t *self, uint32_t i) {
    const kernel_t own = kernel(self->tone[i].turn, self->window.points_log2);
    self->even_half.matrix[ldlt_index(even_row(i), 0)] = own.d0;
    self->even_half.matrix[ldlt_index(even_row(i) + 1u, 0)] = own.d1;
}

// The component's coupling to the constant, then to those before it and to itself. Returns its
// cost.
static uint32_t couple_next(tone_fit_t *self) {
    const uint32_t partner = self->other;
    self->other++;
    if (partner == 0) {
        couple_constant(self, self->slot);
        return PAIRS_A_COUPLING / 2u;
    }
    couple(self, self->slot, partner - 1u);
    if (partner > self->slot) {
        self->slot++;
        self->other = 0;
    }
    return PAIRS_A_COUPLING;
}

// At least one coupling. Returns true iff all are there.
static bool couple_some(tone_fit_t *self, uint32_t pairs) {
    for (uint32_t cost = 0; cost == 0 || cost < pairs;) {
        if (self->slot == self->slots) {
            return true;
        }
        cost += couple_next(self);
    }
    return self->slot == self->slots;
}

// At least one column. Returns true iff the half is solved.
static bool solve_some(ldlt_t *half, uint32_t pairs) {
    for (uint32_t cost = 0; cost == 0 || cost < pairs; cost += half->size * half->size + 2u) {
        if (ldlt_step(half)) {
            return true;
        }
    }
    return false;
}

static void end_projection(tone_fit_t *self) {
    keep_projection(self);
    self->slot++;
    if (self->slot < self->slots) {
        start_projection(self);
        return;
    }
    self->slot = 0;
    self->other = 0;
    enter(self, TONE_FIT_COUPLE);
}

// numerator / denominator in Q29, |.| limited to RADIANS_LIMIT; denominator > 0.
static int32_t radians_q29(int64_t numerator, uint64_t denominator) {
    // Down to 31 bits of denominator, so that one 64-bit division does.
    const uint32_t bits = 64u - leading_zeros_u64(denominator);
    const uint32_t down = bits > 31u ? bits - 31u : 0u;
    const int64_t below = (int64_t)(denominator >> down);
    const int64_t above = clamp_i64(numerator >> down, -4 * below, 4 * below);
    return (int32_t)clamp_i64(above * (1 << 29) / below, -RADIANS_LIMIT_Q29, RADIANS_LIMIT_Q29);
}

// Radians over half a window (Q29) as turns a sample (Q32): x 8 / (pi N).
static int32_t as_turn(int32_t shift_q29, uint32_t points_log2) {
    const int64_t eight_over_pi_q28 = 683565276;
    return (int32_t)((shift_q29 * eight_over_pi_q28) >> (28u + points_log2));
}

static int32_t in_um_s2(const tone_fit_t *self, uint64_t value_q8) {
    // Data may have been scaled up or down; both shifts stay within the word.
    const int32_t down = self->up_shift + RIGHT_BITS;
    const uint64_t value = down >= 0 ? value_q8 >> down : value_q8 << -down;
    return (int32_t)(value > INT32_MAX ? INT32_MAX : value);
}

// Variance of the frequency in units of residual variance over amplitude squared: 1 / (N D), D the
// pivot of the slope.
static uint32_t sigma_turn(const tone_fit_t *self, uint32_t slot, uint64_t amp_square_q16,
                           uint64_t residual_q16) {
    const int32_t even = self->even_half.pivot_q30[even_row(slot) + 1u];
    const int32_t odd = self->odd_half.pivot_q30[odd_row(slot) + 1u];
    const int32_t pivot_q30 = even < odd ? even : odd;
    if (pivot_q30 == 0 || amp_square_q16 == 0) {
        return UINT32_MAX;
    }
    // (residual / amp^2) / pivot in Q40, then / N and the root: radians over half a window in Q20.
    const uint32_t bits = 64u - leading_zeros_u64(residual_q16 | 1u);
    const uint32_t up = bits < 40u ? 40u - bits : 0u;
    const uint32_t down = 40u - (up < 40u ? up : 40u);
    const uint64_t scaled_down = amp_square_q16 >> down;
    const uint64_t ratio_q40 = (residual_q16 << up) / (scaled_down == 0 ? 1u : scaled_down);
    const uint64_t limited = ratio_q40 > (UINT64_C(1) << 33) ? UINT64_C(1) << 33 : ratio_q40;
    const uint64_t variance_q40 =
        ((limited << 30) / (uint32_t)pivot_q30) >> self->window.points_log2;
    const uint64_t root_q20 = sqrt_fast_u64(variance_q40);
    // x 2^32 / (pi N).
    return (uint32_t)((root_q20 * 1304) >> self->window.points_log2);
}

static void read_tone(tone_fit_t *self, uint32_t slot) {
    tone_t *tone = &self->tone[slot];
    const int32_t a = self->even_half.right[even_row(slot)];
    const int32_t p = self->even_half.right[even_row(slot) + 1u];
    const int32_t b = self->odd_half.right[odd_row(slot)];
    const int32_t q = self->odd_half.right[odd_row(slot) + 1u];
    const uint64_t square = (uint64_t)((int64_t)a * a + (int64_t)b * b);
    const int64_t turned = (int64_t)b * q - (int64_t)a * p;
    tone->shift_q29 = radians_q29(turned, square == 0 ? 1u : square);
    tone->turn += (uint32_t)as_turn(tone->shift_q29, self->window.points_log2);
    tone->phase_turn = atan2_turn(-b, a);
    tone->amp_um_s2 = in_um_s2(self, isqrt_u64(square));
}

static void read_sigma(tone_fit_t *self, uint32_t slot) {
    const int64_t a = self->even_half.right[even_row(slot)];
    const int64_t b = self->odd_half.right[odd_row(slot)];
    self->tone[slot].sigma_turn =
        sigma_turn(self, slot, (uint64_t)(a * a + b * b), self->residual_q16);
}

// Reads how much of the window's energy about its mean the fit explains; returns the variance of
// what it leaves, Q16 of the data's unit.
static uint64_t read_energy(tone_fit_t *self) {
    const uint32_t log2 = self->window.points_log2;
    const int64_t mean_q8 = (self->constant * (1 << RIGHT_BITS)) >> log2;
    const int64_t all_q16 = (int64_t)(self->energy >> log2) * (1 << (2 * RIGHT_BITS - 1));
    const int64_t total_q16 = clamp_i64(all_q16 - mean_q8 * mean_q8, 1, INT64_MAX);
    const int64_t fitted_q16 = self->even_half.energy + self->odd_half.energy;
    const int64_t left_q16 = clamp_i64(all_q16 - fitted_q16, 0, total_q16);
    self->explained_q16 = (uint32_t)((total_q16 - left_q16) / ((total_q16 >> 16) + 1));
    // Every unknown has taken a degree of freedom.
    const uint32_t freedom = (1u << log2) - self->even_half.size - self->odd_half.size;
    return ((uint64_t)left_q16 / freedom) << log2;
}

// A constant in samples' units, the window's rough mean included.
static int32_t offset_um_s2(const tone_fit_t *self, int64_t value_q8) {
    const int32_t size = in_um_s2(self, (uint64_t)(value_q8 < 0 ? -value_q8 : value_q8));
    const int64_t sum = (int64_t)self->window.mean_um_s2 + (value_q8 < 0 ? -size : size);
    return (int32_t)clamp_i64(sum, -INT32_MAX, INT32_MAX);
}

static void read_whole(tone_fit_t *self) {
    self->residual_q16 = read_energy(self);
    self->residual_um_s2 = in_um_s2(self, sqrt_fast_u64(self->residual_q16));
    const int64_t constant = self->even_half.right[0];
    int64_t slow = constant;
    self->slope_um_s2 = 0;
    self->bend_um_s2 = 0;
    if (self->slots > self->tones) {
        // u is a quarter cycle: at the window's end cosines are 0 and sines 1.
        const int32_t *even = &self->even_half.right[even_row(self->tones)];
        const int32_t *odd = &self->odd_half.right[odd_row(self->tones)];
        slow += (int64_t)even[1] + odd[0];
        const int64_t slope = even[1] - (((int64_t)even[0] + odd[1]) * HALF_PI_Q16 >> 16);
        self->slope_um_s2 = offset_um_s2(self, slope) - self->window.mean_um_s2;
        const int64_t size =
            (slope < 0 ? -slope : slope) + (slow < constant ? constant - slow : slow - constant);
        self->bend_um_s2 = in_um_s2(self, (uint64_t)size / 16u);
    }
    self->constant_um_s2 = offset_um_s2(self, constant);
    self->end_um_s2 = offset_um_s2(self, slow);
    self->slot = 0;
    self->other = 0;
}

// Half of a component's figures. Returns true iff all are read.
static bool read_next(tone_fit_t *self) {
    if (self->other == 0) {
        read_tone(self, self->slot);
        self->other = 1;
    } else {
        read_sigma(self, self->slot);
        self->other = 0;
        self->slot++;
    }
    return self->slot >= self->tones;
}

static bool is_all_done(const tone_fit_t *self) {
    return self->done == pairs_of(self);
}

bool tone_fit_step(tone_fit_t *self, uint32_t pairs) {
    switch (self->stage) {
    case TONE_FIT_GATHER:
        gather(self, (2u * pairs + 2u) / 3u); // dearer than projecting
        if (!is_all_done(self)) {
            return false;
        }
        if (!has_right_scale(self)) {
            start_gathering(self); // the ring still has the samples
            return false;
        }
        self->stage = TONE_FIT_GATHERED;
        return true;
    case TONE_FIT_PROJECT:
        project(self, pairs);
        if (is_all_done(self)) {
            self->stage = TONE_FIT_PROJECTED;
        }
        return false;
    case TONE_FIT_PROJECTED:
        end_projection(self);
        return false;
    case TONE_FIT_COUPLE:
        if (couple_some(self, pairs)) {
            self->stage = TONE_FIT_SOLVE_EVEN;
        }
        return false;
    case TONE_FIT_SOLVE_EVEN:
        self->stage =
            solve_some(&self->even_half, pairs) ? TONE_FIT_SOLVE_ODD : TONE_FIT_SOLVE_EVEN;
        return false;
    case TONE_FIT_SOLVE_ODD:
        self->stage = solve_some(&self->odd_half, pairs) ? TONE_FIT_SUM_UP : TONE_FIT_SOLVE_ODD;
        return false;
    case TONE_FIT_SUM_UP:
        read_whole(self);
        self->stage = TONE_FIT_READ;
        return false;
    case TONE_FIT_READ:
        self->stage = read_next(self) ? TONE_FIT_DONE : TONE_FIT_READ;
        return self->stage == TONE_FIT_DONE;
    default:
        return true;
    }
}
