#include "network.h"

#include <stddef.h>

#include "activation.h"
#include "fixq.h"
#include "quiesce_board.h"
#include "view.h"

enum { DENSE_TANH, DENSE_LINE, RADIAL, RADIAL_NORMALISED, KINDS };

enum {
    HEADER_WORDS = 6,
    INPUT_WORDS = 5,
    LAYER_WORDS = 2,
    DENSE_WORDS = 2,  ///< of a unit, beside its weights
    OUTPUT_WORDS = 3, ///< beside its coefficients
    MOST_SHIFT = 60,
    MOST_OUTPUT_SHIFT = 36, ///< of mA; values have 24 more
    Q24 = 24,
    ONE = 1 << Q24,
    WEIGHT_LIMIT = 1 << 24,
    CENTRE_LIMIT = 4 * ONE,
    ARGUMENT_LIMIT = 32 * ONE,
    SIDE_Q20_LIMIT = 1 << 27,
    SIDE_SHIFT = 20, ///< value x sharpness, Q40, to Q20
};

// Instructions, as counted on a Cortex-M4.
enum {
    NETWORK_WORK = 120,
    INPUT_WORK = 40,
    DENSE_WORK = 140,
    DENSE_VALUE_WORK = 8,
    RADIAL_WORK = 90,
    NORMALISED_WORK = 35, ///< of a unit, more
    RADIAL_VALUE_WORK = 30,
};

#define FAR_Q24 (UINT64_C(1) << 31) ///< 128

_Static_assert(offsetof(network_t, input) == 4u * HEADER_WORDS, "words on the wire");
_Static_assert(sizeof(network_input_t) == 4u * INPUT_WORDS, "words on the wire");

typedef struct {
    uint32_t kind;
    uint32_t units;
    int32_t word[];
} layer_t;

typedef struct {
    uint32_t order;
    uint32_t shift;
    int32_t bias;
    int32_t coefficient[];
} output_t;

static bool is_radial(const layer_t *layer) {
    return layer->kind >= RADIAL;
}

// Values that the first layer sees.
static uint32_t values_of(const network_t *self) {
    return self->delay_ticks == 0 ? self->inputs : 2u * self->inputs;
}

static uint32_t unit_words(const layer_t *layer, uint32_t values) {
    return is_radial(layer) ? 2u * values : DENSE_WORDS + values;
}

static uint32_t layer_words(const layer_t *layer, uint32_t values) {
    return LAYER_WORDS + layer->units * unit_words(layer, values);
}

/// A layer, and how many values it sees.
typedef struct {
    const layer_t *layer;
    uint32_t values;
} place_t;

static place_t first_of(const network_t *self) {
    return (place_t){(const layer_t *)(const void *)&self->input[self->inputs], values_of(self)};
}

static const void *after(place_t at) {
    return (const uint32_t *)(const void *)at.layer + layer_words(at.layer, at.values);
}

static place_t next_of(place_t at) {
    return (place_t){after(at), at.layer->units};
}

static place_t last_of(const network_t *self) {
    place_t at = first_of(self);
    for (uint32_t i = 0; i + 1u < self->layers; i++) {
        at = next_of(at);
    }
    return at;
}

static uint32_t coefficients_of(const output_t *output, place_t last) {
    return last.layer->units * (1u + output->order * last.values);
}

// ---- what is refused ----------------------------------------------------------------------------

static bool has_header(const network_t *self, uint32_t count) {
    return count >= HEADER_WORDS && self->inputs >= 1u && self->inputs <= NETWORK_MOST_INPUTS &&
           self->layers >= 1u && self->layers <= NETWORK_MOST_LAYERS &&
           self->delay_ticks <= NETWORK_MOST_DELAY &&
           self->inputs * self->delay_ticks <= NETWORK_PAST &&
           count >= HEADER_WORDS + INPUT_WORDS * self->inputs;
}

static bool has_layer(place_t at, uint32_t left) {
    return left >= LAYER_WORDS && at.layer->kind < KINDS && at.layer->units >= 1u &&
           at.layer->units <= NETWORK_MOST_UNITS && left >= layer_words(at.layer, at.values);
}

static bool has_output(place_t last, uint32_t left) {
    const output_t *output = after(last);
    return left >= OUTPUT_WORDS && output->order <= 1u &&
           left >= OUTPUT_WORDS + coefficients_of(output, last);
}

uint32_t network_size(const uint32_t *words, uint32_t count) {
    const network_t *self = network_of(words);
    if (!has_header(self, count)) {
        return 0;
    }
    place_t at = first_of(self);
    place_t last = at;
    uint32_t left = count - HEADER_WORDS - INPUT_WORDS * self->inputs;
    for (uint32_t i = 0; i < self->layers; i++) {
        if (!has_layer(at, left)) {
            return 0;
        }
        left -= layer_words(at.layer, at.values);
        last = at;
        at = next_of(at);
    }
    if (!has_output(last, left)) {
        return 0;
    }
    return count - left + OUTPUT_WORDS + coefficients_of(after(last), last);
}

static bool are_below(const int32_t *words, uint32_t count, int32_t limit) {
    bool are_good = true;
    for (uint32_t i = 0; i < count; i++) {
        are_good = are_good && abs_i32(words[i]) < limit;
    }
    return are_good;
}

static bool is_input_good(const network_input_t *input) {
    if (input->low < -VIEW_LIMIT || input->high > VIEW_LIMIT || input->low >= input->high ||
        input->factor < 1 || input->factor > VIEW_LIMIT || input->shift > MOST_SHIFT) {
        return false;
    }
    // Below 2^31 x 2^30.
    const int64_t product = ((int64_t)input->high - input->low) * input->factor;
    return product >> input->shift <= 2 * ONE;
}

static bool is_dense_unit_good(const int32_t *unit, uint32_t values) {
    return (uint32_t)unit[0] <= MOST_SHIFT && are_below(&unit[1], 1u + values, WEIGHT_LIMIT);
}

static bool is_radial_unit_good(const int32_t *unit, uint32_t values) {
    bool are_positive = true;
    for (uint32_t i = 0; i < values; i++) {
        are_positive = are_positive && unit[values + i] >= 0;
    }
    return are_positive && are_below(unit, values, CENTRE_LIMIT + 1) &&
           are_below(&unit[values], values, WEIGHT_LIMIT);
}

static bool is_layer_good(place_t at) {
    bool is_good = true;
    for (uint32_t i = 0; i < at.layer->units; i++) {
        const int32_t *unit = &at.layer->word[i * unit_words(at.layer, at.values)];
        is_good = is_good && (is_radial(at.layer) ? is_radial_unit_good(unit, at.values)
                                                  : is_dense_unit_good(unit, at.values));
    }
    return is_good;
}

static bool is_output_good(place_t last) {
    const output_t *output = after(last);
    return output->shift <= MOST_OUTPUT_SHIFT && abs_i32(output->bias) < WEIGHT_LIMIT &&
           are_below(output->coefficient, coefficients_of(output, last), WEIGHT_LIMIT);
}

bool network_is_good(const network_t *self) {
    bool is_good = self->largest_mA >= 1u && self->largest_mA <= QUIESCE_HIGHEST_CURRENT_mA &&
                   (self->delay_ticks == 0 ? self->rate_Hz == 0 : self->rate_Hz > 0);
    for (uint32_t i = 0; i < self->inputs; i++) {
        is_good = is_good && is_input_good(&self->input[i]);
    }
    place_t at = first_of(self);
    for (uint32_t i = 0; i < self->layers; i++) {
        is_good = is_good && is_layer_good(at);
        at = next_of(at);
    }
    return is_good && is_output_good(last_of(self));
}

static uint32_t layer_work(place_t at) {
    const uint32_t of_unit = is_radial(at.layer) ? RADIAL_WORK + RADIAL_VALUE_WORK * at.values
                                                 : DENSE_WORK + DENSE_VALUE_WORK * at.values;
    const uint32_t more = at.layer->kind == RADIAL_NORMALISED ? NORMALISED_WORK : 0;
    return at.layer->units * (of_unit + more);
}

static uint32_t work_of(const network_t *self) {
    uint32_t sum = NETWORK_WORK + INPUT_WORK * self->inputs;
    const place_t last = last_of(self);
    place_t at = first_of(self);
    for (uint32_t i = 0; i < self->layers; i++) {
        sum += layer_work(at);
        at = next_of(at);
    }
    return sum + DENSE_VALUE_WORK * coefficients_of(after(last), last);
}

const network_t *network_next(const network_t *self) {
    const place_t last = last_of(self);
    const output_t *output = after(last);
    return (const network_t *)(const void *)&output->coefficient[coefficients_of(output, last)];
}

quiesce_table_verdict_t network_table_check(const sections_kind_t *kind, const uint32_t *words) {
    const quiesce_table_verdict_t verdict = sections_check(kind, words);
    if (verdict != QUIESCE_TABLE_OK) {
        return verdict;
    }
    const network_t *network = sections_first(words);
    uint32_t work = 0;
    for (uint32_t i = 0; i < sections_count(words); i++) {
        work += work_of(network);
        network = network_next(network);
    }
    return work <= NETWORK_MOST_WORK ? QUIESCE_TABLE_OK : QUIESCE_TABLE_SHAPE;
}

uint32_t network_table_rate_Hz(const uint32_t *words) {
    const network_t *network = sections_first(words);
    uint32_t found_Hz = TABLE_ANY_RATE;
    for (uint32_t i = 0; i < sections_count(words); i++) {
        const uint32_t rate_Hz = (uint32_t)network->rate_Hz;
        if (rate_Hz != 0 && found_Hz != TABLE_ANY_RATE && rate_Hz != found_Hz) {
            return 0;
        }
        found_Hz = rate_Hz != 0 ? rate_Hz : found_Hz;
        network = network_next(network);
    }
    return found_Hz;
}

// ---- a tick -------------------------------------------------------------------------------------

// Into -1 .. 1: 0 .. 2 by the check, less 1. Rounded down.
static int32_t scaled_q24(const network_input_t *input, int32_t value) {
    const int64_t above = (int64_t)clamp_i32(value, input->low, input->high) - input->low;
    return (int32_t)((above * input->factor) >> input->shift) - ONE;
}

static void see(const network_t *self, network_past_t *past, const int32_t *values, int32_t *x) {
    const uint32_t m = self->inputs;
    for (uint32_t i = 0; i < m; i++) {
        x[i] = scaled_q24(&self->input[i], values[i]);
    }
    if (self->delay_ticks == 0) {
        return;
    }
    int32_t *before = &past->x_q24[past->at * m];
    for (uint32_t i = 0; i < m; i++) {
        x[m + i] = before[i];
        before[i] = x[i];
    }
    past->at = past->at + 1u < self->delay_ticks ? past->at + 1u : 0;
}

static int64_t dot(int64_t sum, const int32_t *a, const int32_t *b, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        sum += (int64_t)a[i] * b[i];
    }
    return sum;
}

static int32_t dense_q24(const int32_t *unit, bool is_tanh, const int32_t *x, uint32_t values) {
    const int64_t sum = dot((int64_t)unit[1] * ONE, &unit[2], x, values) >> unit[0];
    return is_tanh ? tanh_q24((int32_t)clamp_i64(sum, -ARGUMENT_LIMIT, ARGUMENT_LIMIT))
                   : (int32_t)clamp_i64(sum, -ONE, ONE);
}

// Squares, Q40, below 2^54 each.
static uint32_t distance_q24(const int32_t *unit, const int32_t *x, uint32_t values) {
    uint64_t sum_q40 = 0;
    for (uint32_t i = 0; i < values; i++) {
        // Below 5 x 2^24 x 2^24.
        const int64_t product = (int64_t)(x[i] - unit[i]) * unit[values + i];
        const int64_t side = clamp_i64(product >> SIDE_SHIFT, -SIDE_Q20_LIMIT, SIDE_Q20_LIMIT);
        sum_q40 += (uint64_t)(side * side);
    }
    const uint64_t sum_q24 = sum_q40 >> 16;
    return (uint32_t)(sum_q24 < FAR_Q24 ? sum_q24 : FAR_Q24);
}

// From distances to parts of their sum. The nearest one is 1 before that: the sum is 1 .. 32.
static void normalise(const uint32_t *distance, int32_t *y, uint32_t units) {
    uint32_t nearest = distance[0];
    for (uint32_t i = 1; i < units; i++) {
        nearest = distance[i] < nearest ? distance[i] : nearest;
    }
    uint32_t sum = 0;
    for (uint32_t i = 0; i < units; i++) {
        y[i] = (int32_t)exp_minus_q24(distance[i] - nearest);
        sum += (uint32_t)y[i];
    }
    sum = sum > (uint32_t)ONE ? sum : (uint32_t)ONE; // the nearest one alone is that
    const uint32_t up = leading_zeros_u64(sum) - 32u;
    const uint32_t reciprocal = reciprocal_u32(sum << up); // 2^63 / (sum x 2^up)
    for (uint32_t i = 0; i < units; i++) {
        const uint64_t part = (uint64_t)(uint32_t)y[i] * reciprocal >> (63u - Q24 - up);
        y[i] = (int32_t)(part < ONE ? part : ONE);
    }
}

static void pass_radial(place_t at, const int32_t *x, int32_t *y) {
    uint32_t distance[NETWORK_MOST_UNITS] = {0};
    for (uint32_t i = 0; i < at.layer->units; i++) {
        distance[i] = distance_q24(&at.layer->word[i * 2u * at.values], x, at.values);
    }
    if (at.layer->kind == RADIAL_NORMALISED) {
        normalise(distance, y, at.layer->units);
        return;
    }
    for (uint32_t i = 0; i < at.layer->units; i++) {
        y[i] = (int32_t)exp_minus_q24(distance[i]);
    }
}

static void pass(place_t at, const int32_t *x, int32_t *y) {
    if (is_radial(at.layer)) {
        pass_radial(at, x, y);
        return;
    }
    for (uint32_t i = 0; i < at.layer->units; i++) {
        const int32_t *unit = &at.layer->word[i * (DENSE_WORDS + at.values)];
        y[i] = dense_q24(unit, at.layer->kind == DENSE_TANH, x, at.values);
    }
}

// In units of 2^-(24 + shift) mA.
static int64_t conclude(place_t last, const int32_t *x, const int32_t *y) {
    const output_t *output = after(last);
    int64_t sum = (int64_t)output->bias * ONE;
    if (output->order == 0) {
        return dot(sum, output->coefficient, y, last.layer->units);
    }
    for (uint32_t i = 0; i < last.layer->units; i++) {
        const int32_t *rule = &output->coefficient[i * (1u + last.values)];
        // Below 33 x 2^24.
        sum += (dot((int64_t)rule[0] * ONE, &rule[1], x, last.values) >> Q24) * y[i];
    }
    return sum;
}

int32_t network_current_mA(const network_t *self, network_past_t *past, const int32_t *values) {
    int32_t x[2][NETWORK_MOST_UNITS] = {{0}}; // what a layer sees, and what it makes, in turns
    place_t at = first_of(self);
    see(self, past, values, x[0]);
    for (uint32_t i = 0; i + 1u < self->layers; i++) {
        pass(at, x[i % 2u], x[(i + 1u) % 2u]);
        at = next_of(at);
    }
    const int32_t *seen = x[(self->layers - 1u) % 2u];
    int32_t *made = x[self->layers % 2u];
    pass(at, seen, made);
    const uint32_t shift = Q24 + ((const output_t *)after(at))->shift;
    const int64_t half = INT64_C(1) << (shift - 1u);
    return (int32_t)clamp_i64((conclude(at, seen, made) + half) >> shift, 0,
                              (int64_t)self->largest_mA);
}
