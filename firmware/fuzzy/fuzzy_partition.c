// Tables where some rule always fires with 1/2 or more: at most four rules, sums that fit 32 bits.
#include "fuzzy_forms.h"

typedef struct {
    uint64_t weighted;
    uint32_t strength;
} sums_t;

static void add_singleton(sums_t *sums, uint32_t strength, uint32_t singleton) {
    sums->weighted += (uint64_t)strength * singleton;
    sums->strength += strength;
}

static const fuzzy_pair_cell_t *find_pair(const fuzzy_table_t *table, uint32_t i, int32_t input) {
    const fuzzy_pair_cell_t *cell = fuzzy_at(table, table->axis[i].offset);
    while (input > cell->cell.last) {
        cell++;
    }
    return cell;
}

// How high what lies between two sets that overlap is filled.
static uint32_t between(const fuzzy_layer_t *layer, const uint32_t *strength) {
    uint32_t most = 0;
    for (uint32_t i = layer->first + 1u; i < layer->second; i++) {
        most = fuzzy_max(most, strength[i]);
    }
    return most;
}

// Adds a layer, filled as far as a strength above its start goes, to `to`.
static inline void add_layer(const fuzzy_layer_t *layer, uint32_t bits, uint32_t beta,
                             fuzzy_sums_t *to, fuzzy_sums_t *opposite) {
    const uint32_t filled = fuzzy_min(beta - layer->start, layer->height);
    const uint32_t beta_q30 = filled << (30u - bits);
    fuzzy_add_area(to, layer->flanks, beta_q30);
    if (layer->flanks.skew_q27 != 0) {
        fuzzy_add_skew((layer->marks & FUZZY_SKEWED_LEFT) != 0 ? opposite : to, layer->flanks,
                       beta_q30);
    }
}

// What the sets between two that overlap have already given.
static void add_again(const fuzzy_layer_t *layer, uint32_t bits, uint32_t lower, fuzzy_sums_t *more,
                      fuzzy_sums_t *less) {
    if (lower > layer->start) {
        add_layer(layer, bits, lower, more, less);
    }
}

// Every set's peak is 1, so that layers end below it by themselves.
static int32_t partition_centre(const fuzzy_table_t *table, const fuzzy_output_t *output,
                                const uint32_t *strength) {
    const uint32_t *peak = fuzzy_at(table, output->terms_offset);
    const fuzzy_layer_t *layer = (const fuzzy_layer_t *)(const void *)(peak + output->terms);
    const fuzzy_layer_t *overlaps = layer + output->term_layers;
    const fuzzy_layer_t *end = layer + output->layers;
    const uint32_t bits = table->bits;
    fuzzy_sums_t more = {0, 0};
    fuzzy_sums_t less = {0, 0};
    for (; layer < overlaps; layer++) {
        if (strength[layer->first] > layer->start) {
            add_layer(layer, bits, strength[layer->first], &more, &less);
        }
    }
    for (; layer < end; layer++) {
        const uint32_t upper = fuzzy_min(strength[layer->first], strength[layer->second]);
        const uint32_t lower = layer->second - layer->first > 1 ? between(layer, strength) : 0;
        if (upper > layer->start && upper > lower) {
            add_layer(layer, bits, upper, &less, &more);
            add_again(layer, bits, lower, &more, &less);
        }
    }
    return output->origin + (int32_t)fuzzy_centre(more, less, output->span);
}

// Strengths of the four rules, row by row, and the place of the first in the grid.
typedef struct {
    uint32_t a, b, c, d;
    uint32_t place;
} block_t;

// Memberships add up to 1, so two minima give all four: min(p, q) + max(p, q) = p + q.
static inline block_t find_block(const fuzzy_table_t *table, const int32_t *input) {
    const fuzzy_pair_cell_t *row = find_pair(table, 0, input[0]);
    const fuzzy_pair_cell_t *column = find_pair(table, 1, input[1]);
    const uint32_t down = fuzzy_membership(&row->ramp[0], fuzzy_distance(&row->cell, input[0]));
    const uint32_t across =
        fuzzy_membership(&column->ramp[0], fuzzy_distance(&column->cell, input[1]));
    const uint32_t rest = table->one - across;
    const uint32_t a = fuzzy_min(down, across);
    const uint32_t b = fuzzy_min(down, rest);
    return (block_t){
        .a = a,
        .b = b,
        .c = b + across - down,
        .d = a + rest - down,
        .place = column->ramp[0].set + row->ramp[0].set * FUZZY_GRID_STRIDE,
    };
}

static inline void add_two(sums_t *sums, uint32_t s, uint32_t value, uint32_t t, uint32_t other) {
    add_singleton(sums, s, value);
    add_singleton(sums, t, other);
}

static inline sums_t sum_block(const block_t *s, const uint32_t *v) {
    sums_t sums = {0};
    add_two(&sums, s->a, v[0], s->b, v[1]);
    add_two(&sums, s->c, v[FUZZY_GRID_STRIDE], s->d, v[FUZZY_GRID_STRIDE + 1u]);
    return sums;
}

// Rules of one term count once, with the strongest.
static inline sums_t max_block(const block_t *s, const uint32_t *v, uint32_t twins) {
    const uint32_t a = v[0];
    const uint32_t b = v[1];
    const uint32_t c = v[FUZZY_GRID_STRIDE];
    const uint32_t d = v[FUZZY_GRID_STRIDE + 1u];
    sums_t sums = {0};
    switch (twins) {
    case FUZZY_TWINS_AB:
        add_singleton(&sums, fuzzy_max(s->a, s->b), a);
        add_two(&sums, s->c, c, s->d, d);
        break;
    case FUZZY_TWINS_AC:
        add_singleton(&sums, fuzzy_max(s->a, s->c), a);
        add_two(&sums, s->b, b, s->d, d);
        break;
    case FUZZY_TWINS_AD:
        add_singleton(&sums, fuzzy_max(s->a, s->d), a);
        add_two(&sums, s->b, b, s->c, c);
        break;
    case FUZZY_TWINS_BC:
        add_singleton(&sums, fuzzy_max(s->b, s->c), b);
        add_two(&sums, s->a, a, s->d, d);
        break;
    case FUZZY_TWINS_BD:
        add_singleton(&sums, fuzzy_max(s->b, s->d), b);
        add_two(&sums, s->a, a, s->c, c);
        break;
    case FUZZY_TWINS_CD:
        add_singleton(&sums, fuzzy_max(s->c, s->d), c);
        add_two(&sums, s->a, a, s->b, b);
        break;
    case FUZZY_TWINS_AB_CD:
        add_two(&sums, fuzzy_max(s->a, s->b), a, fuzzy_max(s->c, s->d), c);
        break;
    case FUZZY_TWINS_AC_BD:
        add_two(&sums, fuzzy_max(s->a, s->c), a, fuzzy_max(s->b, s->d), b);
        break;
    case FUZZY_TWINS_AD_BC:
        add_two(&sums, fuzzy_max(s->a, s->d), a, fuzzy_max(s->b, s->c), b);
        break;
    case FUZZY_TWINS_ABC:
        add_two(&sums, fuzzy_max(fuzzy_max(s->a, s->b), s->c), a, s->d, d);
        break;
    case FUZZY_TWINS_ABD:
        add_two(&sums, fuzzy_max(fuzzy_max(s->a, s->b), s->d), a, s->c, c);
        break;
    case FUZZY_TWINS_ACD:
        add_two(&sums, fuzzy_max(fuzzy_max(s->a, s->c), s->d), a, s->b, b);
        break;
    case FUZZY_TWINS_BCD:
        add_two(&sums, fuzzy_max(fuzzy_max(s->b, s->c), s->d), b, s->a, a);
        break;
    case FUZZY_TWINS_ALL:
        add_singleton(&sums, 1u, a);
        break;
    default:
        return sum_block(s, v);
    }
    return sums;
}

static inline int32_t average(const fuzzy_table_t *table, sums_t sums) {
    return table->origin +
           (int32_t)fuzzy_short_quotient(sums.weighted, sums.strength << table->fraction);
}

uint32_t fuzzy_partition_sum(const fuzzy_table_t *table, const int32_t *input, int32_t *value) {
    const block_t block = find_block(table, input);
    const uint32_t *values = (const uint32_t *)(table + 1) + block.place;
    *value = average(table, sum_block(&block, values));
    return 0;
}

uint32_t fuzzy_partition_max(const fuzzy_table_t *table, const int32_t *input, int32_t *value) {
    const block_t block = find_block(table, input);
    const uint32_t *values = (const uint32_t *)(table + 1) + block.place;
    const uint32_t *twins = fuzzy_at(table, table->twins_offset);
    *value = average(table, max_block(&block, values, twins[block.place]));
    return 0;
}

// Also with a table that was damaged since its check it stays among the strengths.
static void raise(uint32_t *strength, uint32_t term, uint32_t to) {
    uint32_t *known = &strength[term % FUZZY_STRENGTHS];
    *known = fuzzy_max(*known, to);
}

uint32_t fuzzy_partition_centroid(const fuzzy_table_t *table, const int32_t *input,
                                  int32_t *value) {
    const block_t block = find_block(table, input);
    const uint32_t *term = (const uint32_t *)(table + 1) + block.place;
    uint32_t strength[FUZZY_STRENGTHS] = {0};
    raise(strength, term[0], block.a);
    raise(strength, term[1], block.b);
    raise(strength, term[FUZZY_GRID_STRIDE], block.c);
    raise(strength, term[FUZZY_GRID_STRIDE + 1u], block.d);
    *value = partition_centre(table, fuzzy_output_of(table, 0), strength);
    return 0;
}
