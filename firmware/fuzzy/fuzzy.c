#include "fuzzy.h"

#include "fuzzy_math.h"

// Memberships of all inputs, rows of 8 as in a condition's byte.
typedef struct {
    uint32_t of[FUZZY_MAX_INPUTS * 8u];
} memberships_t;

typedef struct {
    uint64_t weighted;
    uint32_t strength;
} sums_t;

// distance: (input - first) << shift; below 2^31 wherever b is not 0.
static uint32_t membership(const fuzzy_ramp_t *ramp, uint32_t distance) {
    const int64_t a = (int64_t)((uint64_t)(uint32_t)ramp->a_high << 32 | ramp->a_low);
    return fuzzy_ramp(a, ramp->b, distance);
}

static uint32_t distance_in(const fuzzy_cell_t *cell, int32_t input) {
    return ((uint32_t)input - (uint32_t)cell->first) << cell->shift;
}

// ---- any table ----------------------------------------------------------------------------------

static const fuzzy_cell_t *find_cell(const fuzzy_table_t *table, uint32_t i, int32_t input) {
    const uint32_t *words = fuzzy_at(table, table->axis[i].offset);
    const fuzzy_cell_t *cell = (const fuzzy_cell_t *)(const void *)words;
    while (input > cell->last) {
        words += table->axis[i].stride;
        cell = (const fuzzy_cell_t *)(const void *)words;
    }
    return cell;
}

static void find_memberships(const fuzzy_table_t *table, const int32_t *input, memberships_t *out) {
    for (uint32_t i = 0; i < 8u * table->inputs; i++) {
        out->of[i] = 0;
    }
    for (uint32_t i = 0; i < table->inputs; i++) {
        const fuzzy_cell_t *cell = find_cell(table, i, input[i]);
        const fuzzy_ramp_t *ramp = (const fuzzy_ramp_t *)(const void *)(cell + 1);
        const uint32_t distance = distance_in(cell, input[i]);
        for (uint32_t k = 0; k < cell->ramps; k++) {
            out->of[8u * i + ramp[k].set] = membership(&ramp[k], distance);
        }
    }
}

static uint32_t rule_strength(const fuzzy_rule_t *rule, const memberships_t *memberships,
                              uint32_t one) {
    const bool is_or = (rule->head >> 20 & 1u) != 0;
    const uint32_t count = rule->head >> 24;
    uint32_t strength = is_or ? 0 : one;
    for (uint32_t k = 0; k < count; k++) {
        const uint32_t condition = rule->condition[k];
        const uint32_t direct = memberships->of[condition & 31u];
        const uint32_t here = condition >> 7 != 0 ? one - direct : direct;
        strength = is_or ? fuzzy_max(strength, here) : fuzzy_min(strength, here);
    }
    const uint32_t weight_q19 = rule->head & FUZZY_WEIGHT_MASK;
    return weight_q19 == FUZZY_WEIGHT_ONE_q19 ? strength : fuzzy_weighted(strength, weight_q19);
}

static const fuzzy_rule_t *rules_of(const fuzzy_table_t *table) {
    return fuzzy_at(table, table->rules_offset);
}

// ---- outputs ------------------------------------------------------------------------------------

static void add_singleton(sums_t *sums, uint32_t strength, uint32_t singleton) {
    sums->weighted += (uint64_t)strength * singleton;
    sums->strength += strength;
}

static uint32_t from_sums(const fuzzy_output_t *output, const sums_t *sums, int32_t *value) {
    if (sums->strength == 0) {
        *value = output->value_default;
        return 1;
    }
    *value = output->origin + (int32_t)fuzzy_quotient(sums->weighted, sums->strength);
    return 0;
}

static uint32_t weighted_average(const fuzzy_table_t *table, const fuzzy_output_t *output,
                                 const uint32_t *strength, int32_t *value) {
    const uint32_t *singleton = fuzzy_at(table, output->terms_offset);
    sums_t sums = {0};
    for (uint32_t i = 0; i < output->terms; i++) {
        add_singleton(&sums, strength[i], singleton[i]);
    }
    return from_sums(output, &sums, value);
}

// How far an overlap of two is filled: from what lies between them up to the lower of the two.
static uint32_t between(const fuzzy_layer_t *layer, const uint32_t *strength) {
    uint32_t most = 0;
    for (uint32_t i = layer->first + 1u; i < layer->second; i++) {
        most = fuzzy_max(most, strength[i]);
    }
    return most;
}

typedef struct {
    fuzzy_wide_sums_t more;
    fuzzy_wide_sums_t less;
} wide_balance_t;

static void add_wide_layer(const fuzzy_layer_t *layer, uint32_t bits, uint32_t beta,
                           fuzzy_wide_sums_t *to, fuzzy_wide_sums_t *from) {
    const uint32_t height = fuzzy_fill_height(beta, layer->start, layer->height);
    fuzzy_add_wide_area(to, layer->flanks, layer->steep, bits, height);
    fuzzy_add_wide_skew((layer->marks & FUZZY_SKEWED_LEFT) != 0 ? from : to, layer->flanks,
                        layer->steep, bits, height);
}

// Sets in any arrangement, one stretch of the output after the other: in a stretch no set crosses
// another, and from the highest down each adds what its strength exceeds those above it.
static uint32_t stacked_centre(const fuzzy_table_t *table, const fuzzy_output_t *output,
                               const fuzzy_layer_t *layer, const uint32_t *strength) {
    wide_balance_t sums = {{0, 0}, {0, 0}};
    uint32_t lower = 0;
    uint32_t upper = 0;
    for (uint32_t i = 0; i < output->layers; i++, layer++) {
        if ((layer->marks & FUZZY_BEGINS_STRETCH) != 0) {
            upper = 0;
        }
        if ((layer->marks & FUZZY_BEGINS_SET) != 0) {
            lower = upper;
            upper = fuzzy_max(upper, strength[layer->first]);
        }
        if (upper > lower) {
            add_wide_layer(layer, table->bits, upper, &sums.more, &sums.less);
            add_wide_layer(layer, table->bits, lower, &sums.less, &sums.more);
        }
    }
    return fuzzy_wide_centre(sums.more, sums.less, output->span);
}

static uint32_t ordered_centre(const fuzzy_table_t *table, const fuzzy_output_t *output,
                               const fuzzy_layer_t *layer, const uint32_t *strength) {
    wide_balance_t sums = {{0, 0}, {0, 0}};
    for (uint32_t i = 0; i < output->layers; i++, layer++) {
        const uint32_t upper = fuzzy_min(strength[layer->first], strength[layer->second]);
        const uint32_t lower = between(layer, strength);
        if (layer->first == layer->second) {
            add_wide_layer(layer, table->bits, upper, &sums.more, &sums.less);
        } else if (upper > lower) {
            add_wide_layer(layer, table->bits, upper, &sums.less, &sums.more);
            add_wide_layer(layer, table->bits, lower, &sums.more, &sums.less);
        }
    }
    return fuzzy_wide_centre(sums.more, sums.less, output->span);
}

static uint32_t centroid(const fuzzy_table_t *table, const fuzzy_output_t *output,
                         uint32_t *strength, int32_t *value) {
    const uint32_t *peak = fuzzy_at(table, output->terms_offset);
    uint32_t strongest = 0;
    for (uint32_t i = 0; i < output->terms; i++) {
        strength[i] = fuzzy_min(strength[i], peak[i]);
        strongest = fuzzy_max(strongest, strength[i]);
    }
    if (strongest == 0) {
        *value = output->value_default;
        return 1;
    }
    const fuzzy_layer_t *layer = (const fuzzy_layer_t *)(const void *)(peak + output->terms);
    *value = output->origin + (int32_t)(output->term_layers == 0
                                            ? stacked_centre(table, output, layer, strength)
                                            : ordered_centre(table, output, layer, strength));
    return 0;
}

static uint32_t by_terms(const fuzzy_table_t *table, const fuzzy_output_t *output,
                         uint32_t *strength, int32_t *value) {
    return output->method == FUZZY_CENTROID ? centroid(table, output, strength, value)
                                            : weighted_average(table, output, strength, value);
}

static const fuzzy_output_t *output_of(const fuzzy_table_t *table, uint32_t index) {
    return fuzzy_at(table, table->output_offset[index]);
}

static uint32_t evaluate_output(const fuzzy_table_t *table, uint32_t index,
                                const memberships_t *memberships, int32_t *value) {
    const fuzzy_output_t *output = output_of(table, index);
    const uint32_t *singleton = fuzzy_at(table, output->terms_offset);
    const fuzzy_rule_t *rule = rules_of(table);
    const uint32_t one = UINT32_C(1) << table->bits;
    uint32_t strongest[FUZZY_MAX_TERMS] = {0};
    sums_t sums = {0};
    for (uint32_t i = 0; i < table->rules; i++) {
        const uint32_t term = rule[i].conclusion[index];
        if (term == FUZZY_NO_TERM) {
            continue;
        }
        const uint32_t strength = rule_strength(&rule[i], memberships, one);
        if (output->method == FUZZY_SUM) {
            add_singleton(&sums, strength, singleton[term]);
        } else {
            strongest[term] = fuzzy_max(strongest[term], strength);
        }
    }
    return output->method == FUZZY_SUM ? from_sums(output, &sums, value)
                                       : by_terms(table, output, strongest, value);
}

__attribute__((noinline)) static uint32_t evaluate_any(const fuzzy_table_t *table,
                                                       const int32_t *input, int32_t *value) {
    memberships_t memberships;
    find_memberships(table, input, &memberships);
    uint32_t is_default = 0;
    for (uint32_t i = 0; i < table->outputs; i++) {
        is_default |= evaluate_output(table, i, &memberships, &value[i]) << i;
    }
    return is_default;
}

// ---- a grid: at most four rules fire ------------------------------------------------------------

static const fuzzy_pair_cell_t *find_pair(const fuzzy_table_t *table, uint32_t i, int32_t input) {
    const fuzzy_pair_cell_t *cell = fuzzy_at(table, table->axis[i].offset);
    while (input > cell->cell.last) {
        cell++;
    }
    return cell;
}

// Both inputs' cells and the memberships of their sets: all that a grid needs.
typedef struct {
    const fuzzy_ramp_t *row;
    const fuzzy_ramp_t *column;
    uint32_t strength[2][2];
} four_rules_t;

static four_rules_t four_rules(const fuzzy_table_t *table, const int32_t *input) {
    const fuzzy_pair_cell_t *row = find_pair(table, 0, input[0]);
    const fuzzy_pair_cell_t *column = find_pair(table, 1, input[1]);
    four_rules_t out = {.row = row->ramp, .column = column->ramp};
    for (uint32_t i = 0; i < 2u; i++) {
        const uint32_t down = membership(&row->ramp[i], distance_in(&row->cell, input[0]));
        for (uint32_t j = 0; j < 2u; j++) {
            const uint32_t across =
                membership(&column->ramp[j], distance_in(&column->cell, input[1]));
            out.strength[i][j] = fuzzy_min(down, across);
        }
    }
    return out;
}

static const uint32_t *grid_row(const uint32_t *grid, const four_rules_t *rules, uint32_t i) {
    return grid + rules->row[i].set * FUZZY_GRID_STRIDE;
}

static uint32_t grid_sum(const fuzzy_table_t *table, const fuzzy_output_t *output,
                         const four_rules_t *rules, int32_t *value) {
    const uint32_t *grid = fuzzy_at(table, output->grid_values);
    sums_t sums = {0};
    for (uint32_t i = 0; i < 2u; i++) {
        for (uint32_t j = 0; j < 2u; j++) {
            add_singleton(&sums, rules->strength[i][j],
                          grid_row(grid, rules, i)[rules->column[j].set]);
        }
    }
    return from_sums(output, &sums, value);
}

static uint32_t grid_terms(const fuzzy_table_t *table, const fuzzy_output_t *output,
                           const four_rules_t *rules, int32_t *value) {
    const uint32_t *grid = fuzzy_at(table, output->grid_terms);
    uint32_t strongest[FUZZY_MAX_TERMS];
    for (uint32_t i = 0; i < output->terms; i++) {
        strongest[i] = 0;
    }
    for (uint32_t i = 0; i < 2u; i++) {
        for (uint32_t j = 0; j < 2u; j++) {
            uint32_t *here = &strongest[grid_row(grid, rules, i)[rules->column[j].set]];
            *here = fuzzy_max(*here, rules->strength[i][j]);
        }
    }
    return by_terms(table, output, strongest, value);
}

__attribute__((noinline)) static uint32_t evaluate_grid(const fuzzy_table_t *table,
                                                        const int32_t *input, int32_t *value) {
    const four_rules_t rules = four_rules(table, input);
    uint32_t is_default = 0;
    for (uint32_t i = 0; i < table->outputs; i++) {
        const fuzzy_output_t *output = output_of(table, i);
        is_default |= (output->method == FUZZY_SUM ? grid_sum(table, output, &rules, &value[i])
                                                   : grid_terms(table, output, &rules, &value[i]))
                      << i;
    }
    return is_default;
}

// ---- a partition: some rule always fires with 1/2 or more ---------------------------------------

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
    const uint32_t down = membership(&row->ramp[0], distance_in(&row->cell, input[0]));
    const uint32_t across = membership(&column->ramp[0], distance_in(&column->cell, input[1]));
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
    return table->origin + (int32_t)fuzzy_short_quotient(sums.weighted, sums.strength);
}

__attribute__((noinline)) static uint32_t evaluate_sum(const fuzzy_table_t *table,
                                                       const int32_t *input, int32_t *value) {
    const block_t block = find_block(table, input);
    const uint32_t *values = (const uint32_t *)(table + 1) + block.place;
    *value = average(table, sum_block(&block, values));
    return 0;
}

__attribute__((noinline)) static uint32_t evaluate_max(const fuzzy_table_t *table,
                                                       const int32_t *input, int32_t *value) {
    const block_t block = find_block(table, input);
    const uint32_t *values = (const uint32_t *)(table + 1) + block.place;
    const uint32_t *twins = fuzzy_at(table, table->twins_offset);
    *value = average(table, max_block(&block, values, twins[block.place]));
    return 0;
}

static void raise(uint32_t *strength, uint32_t to) {
    *strength = fuzzy_max(*strength, to);
}

__attribute__((noinline)) static uint32_t evaluate_centroid(const fuzzy_table_t *table,
                                                            const int32_t *input, int32_t *value) {
    const block_t block = find_block(table, input);
    const uint32_t *term = (const uint32_t *)(table + 1) + block.place;
    uint32_t strength[FUZZY_MAX_SETS + 1u] = {0};
    raise(&strength[term[0]], block.a);
    raise(&strength[term[1]], block.b);
    raise(&strength[term[FUZZY_GRID_STRIDE]], block.c);
    raise(&strength[term[FUZZY_GRID_STRIDE + 1u]], block.d);
    *value = partition_centre(table, output_of(table, 0), strength);
    return 0;
}

uint32_t fuzzy_evaluate(const fuzzy_table_t *table, const int32_t *input, int32_t *output) {
    switch (table->form) {
    case FUZZY_PARTITION_SUM:
        return evaluate_sum(table, input, output);
    case FUZZY_PARTITION_MAX:
        return evaluate_max(table, input, output);
    case FUZZY_PARTITION_CENTROID:
        return evaluate_centroid(table, input, output);
    case FUZZY_GRID:
        return evaluate_grid(table, input, output);
    default:
        return evaluate_any(table, input, output);
    }
}

uint32_t fuzzy_fired(const fuzzy_table_t *table, const int32_t *input, uint64_t *fired) {
    memberships_t memberships;
    find_memberships(table, input, &memberships);
    const fuzzy_rule_t *rule = rules_of(table);
    uint32_t count = 0;
    *fired = 0;
    for (uint32_t i = 0; i < table->rules; i++) {
        if (rule_strength(&rule[i], &memberships, UINT32_C(1) << table->bits) != 0) {
            *fired |= i < 64u ? UINT64_C(1) << i : 0;
            count++;
        }
    }
    return count;
}
