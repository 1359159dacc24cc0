#include "fft.h"

#include "fft_table.h"

enum {
    ROW_LOG2 = 5,
    QUARTER = FFT_TABLE_POINTS / 4,
    MAX_UP = 20,     // what silence is scaled up by
    LEAST_ZEROS = 2, // leading ones of a scaled sample
    BIN_LIMIT = 1 << 30,
};

void fft_init(fft_t *self, uint32_t points_log2) {
    *self = (fft_t){.points_log2 = points_log2};
}

static uint32_t wrapped(uint32_t index) {
    return index >= FFT_RING ? index - FFT_RING : index;
}

// Ring index of the sample `back` before the newest.
static uint32_t before(const fft_t *self, uint32_t back) {
    return wrapped(self->newest + FFT_RING - back);
}

void fft_push(fft_t *self, int32_t accel_um_s2) {
    const uint32_t leaves = before(self, (1u << self->points_log2) - 1u);
    self->total += (int64_t)accel_um_s2 - self->sample[leaves];
    self->newest = wrapped(self->newest + 1u);
    self->sample[self->newest] = accel_um_s2;
}

void fft_start(fft_t *self) {
    self->oldest = before(self, (1u << self->points_log2) - 1u);
    self->mean_um_s2 = (int32_t)(self->total >> self->points_log2);
    self->bits = 1u;
    self->row_at_work = 0;
    self->done = 0;
    self->stage = FFT_SCALE;
}

// Sample n of the window, 0 the oldest, about its mean: below 2^30.
static int32_t sample_of(const fft_t *self, uint32_t n) {
    return self->sample[wrapped(self->oldest + n)] - self->mean_um_s2;
}

static void scale(fft_t *self, uint32_t first, uint32_t end) {
    uint32_t bits = self->bits;
    for (uint32_t n = first; n < end; n++) {
        const int32_t value = sample_of(self, n);
        bits |= (uint32_t)(value < 0 ? ~value : value); // the bits of its magnitude, or of one less
    }
    const uint32_t up = (uint32_t)__builtin_clz(bits) - LEAST_ZEROS;
    self->bits = bits;
    self->up = up < MAX_UP ? up : MAX_UP;
}

static int32_t high_word(int64_t product) {
    return (int32_t)((product + (INT64_C(1) << 31)) >> 32);
}

// Sample n under the window, 2^(up - 3) to the um/s2: below 2^27.
static int32_t windowed(const fft_t *self, uint32_t n) {
    const uint32_t i = n << (FFT_MAX_LOG2 - self->points_log2);
    const int32_t hann_q29 = fft_hann_q29[i <= FFT_TABLE_POINTS / 2 ? i : FFT_TABLE_POINTS - i];
    return high_word((int64_t)(sample_of(self, n) * (1 << self->up)) * hann_q29);
}

// Two rows become the real and imaginary parts of one, in the order that a transform in place
// wants.
static void load(fft_t *self, uint32_t first, uint32_t end) {
    static const uint8_t reversed[FFT_ROW] = {0,  16, 8,  24, 4,  20, 12, 28, 2,  18, 10,
                                              26, 6,  22, 14, 30, 1,  17, 9,  25, 5,  21,
                                              13, 29, 3,  19, 11, 27, 7,  23, 15, 31};
    const uint32_t stride_log2 = self->points_log2 - ROW_LOG2;
    for (uint32_t m = first; m < end; m++) {
        const uint32_t n = (m << stride_log2) + 2u * self->row_at_work;
        self->row[reversed[m]] = (fft_bin_t){windowed(self, n), windowed(self, n + 1u)};
    }
}

static int32_t cos_q31(uint32_t i) {
    return fft_cosine_q31[i % FFT_TABLE_POINTS];
}

static int32_t sin_q31(uint32_t i) {
    return fft_cosine_q31[(i - QUARTER) % FFT_TABLE_POINTS];
}

// Butterflies of the row's transform, stage by stage, 16 in each.
static void turn(fft_t *self, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++) {
        const uint32_t stage = i / (FFT_ROW / 2);
        const uint32_t half = 1u << stage;
        const uint32_t at = i % half;
        fft_bin_t *low = &self->row[2u * (i % (FFT_ROW / 2) - at) + at];
        fft_bin_t *high = low + half;
        const uint32_t angle = (at * (FFT_TABLE_POINTS / 2)) >> stage;
        const int32_t c = cos_q31(angle);
        const int32_t s = sin_q31(angle);
        const int32_t re = high_word((int64_t)high->re * c + (int64_t)high->im * s);
        const int32_t im = high_word((int64_t)high->im * c - (int64_t)high->re * s);
        *high = (fft_bin_t){(low->re >> 1) - re, (low->im >> 1) - im};
        *low = (fft_bin_t){(low->re >> 1) + re, (low->im >> 1) + im};
    }
}

// Half the product with c + is in Q31, to nearest.
static void add_turned(fft_bin_t *sum, fft_bin_t value, int32_t c, int32_t s) {
    sum->re += high_word((int64_t)value.re * c - (int64_t)value.im * s);
    sum->im += high_word((int64_t)value.im * c + (int64_t)value.re * s);
}

// Adds the row, turned by where its first sample is in the window, to bins +-(first+1) .. +-end of
// what would be the transform of the even samples plus i times the odd ones.
static void add(fft_t *self, uint32_t first, uint32_t end) {
    const uint32_t step = (2u * self->row_at_work) << (FFT_MAX_LOG2 - self->points_log2);
    for (uint32_t k = first + 1u; k <= end; k++) {
        const int32_t c = cos_q31(k * step);
        const int32_t s = sin_q31(k * step);
        if (self->row_at_work == 0) {
            self->bin[k] = (fft_bin_t){0, 0};
            self->mirror[k] = (fft_bin_t){0, 0};
        }
        add_turned(&self->bin[k], self->row[k % FFT_ROW], c, -s);
        add_turned(&self->mirror[k], self->row[(0u - k) % FFT_ROW], c, s);
    }
}

static int32_t rounded(int64_t value, uint32_t shift) {
    const int64_t quotient = (value + (INT64_C(1) << (shift - 1u))) >> shift;
    return (int32_t)clamp_i64(quotient, -BIN_LIMIT, BIN_LIMIT);
}

// Parts the even samples' transform from the odd ones' and joins them to that of all, in um/s2.
static void show(fft_t *self, uint32_t first, uint32_t end) {
    const uint32_t stride = 1u << (FFT_MAX_LOG2 - self->points_log2);
    // Twice a bin in Q31; samples were 2^(up - 3), sums half of it; an amplitude is 4 x 32 / N.
    const uint32_t shift = 1u + 31u + self->up - 3u - 1u + self->points_log2 - 2u - ROW_LOG2;
    for (uint32_t k = first + 1u; k <= end; k++) {
        const fft_bin_t up = self->bin[k];
        const fft_bin_t down = self->mirror[k];
        const fft_bin_t even = {up.re + down.re, up.im - down.im};
        const fft_bin_t odd = {up.im + down.im, down.re - up.re};
        const int32_t c = cos_q31(k * stride);
        const int32_t s = sin_q31(k * stride);
        const int64_t re = (int64_t)odd.re * c + (int64_t)odd.im * s;
        const int64_t im = (int64_t)odd.im * c - (int64_t)odd.re * s;
        self->bin[k] = (fft_bin_t){rounded((int64_t)even.re * (INT64_C(1) << 31) + re, shift),
                                   rounded((int64_t)even.im * (INT64_C(1) << 31) + im, shift)};
    }
}

typedef struct {
    void (*work)(fft_t *, uint32_t first, uint32_t end);
    uint16_t items; ///< 0: one a sample of the window
    uint16_t cost;  ///< of an item, instructions
} task_t;

static const task_t tasks[FFT_STAGES] = {
    [FFT_SCALE] = {scale, 0, 13},
    [FFT_LOAD] = {load, FFT_ROW, 60},
    [FFT_TURN] = {turn, FFT_ROW / 2 * ROW_LOG2, 49},
    [FFT_ADD] = {add, FFT_LAST_BIN, 64},
    [FFT_SHOW] = {show, FFT_LAST_BIN, 90},
};

static uint32_t items_of(const fft_t *self, fft_stage_t stage) {
    return tasks[stage].items != 0 ? tasks[stage].items : 1u << self->points_log2;
}

static uint32_t rows_of(const fft_t *self) {
    return 1u << (self->points_log2 - ROW_LOG2 - 1u);
}

uint32_t fft_cost(const fft_t *self) {
    uint32_t cost = 0;
    for (fft_stage_t stage = FFT_SCALE; stage < FFT_STAGES; stage++) {
        const bool is_a_row = stage == FFT_LOAD || stage == FFT_TURN || stage == FFT_ADD;
        cost += items_of(self, stage) * tasks[stage].cost * (is_a_row ? rows_of(self) : 1u);
    }
    return cost;
}

static fft_stage_t next_stage(fft_t *self) {
    if (self->stage == FFT_SHOW) {
        return FFT_IDLE;
    }
    if (self->stage == FFT_ADD) {
        self->row_at_work++;
        return self->row_at_work < rows_of(self) ? FFT_LOAD : FFT_SHOW;
    }
    return self->stage + 1;
}

bool fft_work(fft_t *self, int32_t *credit) {
    const bool was_at_work = self->stage != FFT_IDLE;
    while (self->stage != FFT_IDLE && *credit >= tasks[self->stage].cost) {
        const task_t *task = &tasks[self->stage];
        const uint32_t items = items_of(self, self->stage);
        uint32_t end = self->done + (uint32_t)*credit / task->cost;
        end = end < items ? end : items;
        task->work(self, self->done, end);
        *credit -= (int32_t)((end - self->done) * task->cost);
        self->done = end;
        if (end == items) {
            self->done = 0;
            self->stage = next_stage(self);
        }
    }
    return was_at_work && self->stage == FFT_IDLE;
}
