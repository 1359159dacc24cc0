// From activated sets to a number: they are looked at in the middle of so many places.
#include "fuzzy_system_forms.h"

enum {
    UNBOUNDED_SHIFT = 6, // room for the sum of FUZZY_SYSTEM_LISTED rules
    ALIKE_q30 = 1 << 12, // heights that differ by rounding only: 2^-18
};

// What is walked over: one output's sets, at place after place.
typedef struct {
    const fuzzy_system_t *table;
    const fuzzy_system_output_t *output;
    uint32_t index;
    const fuzzy_work_t *work;
    uint32_t set_q30[FUZZY_SYSTEM_MAX_TERMS]; // memberships at the place
} walk_t;

static uint32_t terms_of(const walk_t *walk) {
    return fuzzy_min(walk->output->terms, FUZZY_SYSTEM_MAX_TERMS);
}

static uint32_t position_q30(const walk_t *walk, uint32_t place) {
    return (uint32_t)(((uint64_t)(2u * place + 1u) << 29) / walk->output->places);
}

static uint32_t active_q30(const walk_t *walk, uint32_t term) {
    return walk->work->term_q30[fuzzy_term_number(walk->output, term)];
}

static void find_sets(walk_t *walk, uint32_t place) {
    const fuzzy_curve_t *curve = fuzzy_system_at(walk->table, walk->output->terms_offset);
    const int32_t x = (int32_t)position_q30(walk, place);
    for (uint32_t k = 0; k < terms_of(walk); k++) {
        walk->set_q30[k] =
            active_q30(walk, k) == 0 ? 0 : fuzzy_curve_at(walk->table, curve[k], 0, x);
    }
}

static uint32_t aggregated(const walk_t *walk, uint32_t so_far, uint32_t implied_q30) {
    const fuzzy_norm_t norm = (fuzzy_norm_t)walk->output->aggregation;
    const uint32_t more =
        norm == FUZZY_UNBOUNDED_SUM ? implied_q30 >> UNBOUNDED_SHIFT : implied_q30;
    return fuzzy_norm(norm, so_far, more);
}

static uint32_t height_by_term(const walk_t *walk) {
    const fuzzy_norm_t implication = (fuzzy_norm_t)walk->output->implication;
    uint32_t height = 0;
    for (uint32_t k = 0; k < terms_of(walk); k++) {
        const uint32_t strength_q30 = fuzzy_min(active_q30(walk, k), FUZZY_ONE_q30);
        height = aggregated(walk, height, fuzzy_norm(implication, walk->set_q30[k], strength_q30));
    }
    return height;
}

static uint32_t add_rule(const walk_t *walk, const fuzzy_system_rule_t *rule, uint32_t strength_q30,
                         uint32_t height) {
    const fuzzy_norm_t implication =
        (fuzzy_norm_t)fuzzy_system_block(walk->table, rule->block)->implication;
    const uint16_t *conclusion = fuzzy_rule_conclusions(rule);
    uint32_t hedged_q30 = strength_q30;
    for (uint32_t i = 0; i < rule->conclusions; i++) {
        hedged_q30 = fuzzy_hedged(conclusion[i], strength_q30, hedged_q30);
        if ((conclusion[i] & FUZZY_ONLY_HEDGE) == 0 &&
            fuzzy_concluded_output(conclusion[i]) == walk->index) {
            const uint32_t set_q30 = walk->set_q30[conclusion[i] % FUZZY_SYSTEM_MAX_TERMS];
            height = aggregated(walk, height, fuzzy_norm(implication, set_q30, hedged_q30));
        }
    }
    return height;
}

static uint32_t height_by_rule(const walk_t *walk) {
    const fuzzy_system_rule_t *rule = fuzzy_system_at(walk->table, walk->table->rules_offset);
    const uint32_t rules = fuzzy_min(walk->table->rules, FUZZY_SYSTEM_LISTED);
    uint32_t height = 0;
    for (uint32_t i = 0; i < rules; i++) {
        if (walk->work->strength_q30[i] != 0) {
            height = add_rule(walk, rule, walk->work->strength_q30[i], height);
        }
        rule = fuzzy_next_rule(rule);
    }
    return height;
}

// Of all sets together at a place.
static uint32_t height_at(walk_t *walk, uint32_t place) {
    find_sets(walk, place);
    return walk->output->is_by_rule != 0 ? height_by_rule(walk) : height_by_term(walk);
}

// Where on the universe: position / (2 x places) of the span from the origin, to nearest.
static int32_t value_of(const walk_t *walk, uint64_t twice_position_q10) {
    const uint32_t whole = fuzzy_max(walk->output->places, 1u) << 11;
    const uint64_t scaled = twice_position_q10 * walk->output->span;
    return (int32_t)((int64_t)walk->output->origin + (int64_t)((scaled + whole / 2u) / whole));
}

typedef struct {
    uint64_t area;
    uint64_t moment; ///< with 2 place + 1
} areas_t;

static areas_t areas_of(walk_t *walk) {
    areas_t sums = {0, 0};
    for (uint32_t place = 0; place < walk->output->places; place++) {
        const uint32_t height = height_at(walk, place);
        sums.area += height;
        sums.moment += (uint64_t)height * (2u * place + 1u);
    }
    return sums;
}

// Where half of the area lies on either side, straight between a place's ends.
static uint64_t halfway_q10(walk_t *walk, uint64_t area) {
    uint64_t twice = 0;
    for (uint32_t place = 0; place < walk->output->places; place++) {
        const uint64_t height = height_at(walk, place);
        if (twice + 2u * height >= area && height != 0) {
            return ((uint64_t)place << 11) + ((area - twice) << 10) / height;
        }
        twice += 2u * height;
    }
    return 0;
}

typedef struct {
    uint32_t height;
    uint32_t first;
    uint32_t last;
    uint32_t count;
    uint32_t sum; ///< of the places
} highest_t;

static uint32_t greatest_height(walk_t *walk) {
    uint32_t greatest = 0;
    for (uint32_t place = 0; place < walk->output->places; place++) {
        greatest = fuzzy_max(greatest, height_at(walk, place));
    }
    return greatest;
}

static highest_t highest_of(walk_t *walk) {
    highest_t best = {.height = greatest_height(walk)};
    const uint32_t least = best.height - fuzzy_min(best.height, ALIKE_q30);
    for (uint32_t place = 0; place < walk->output->places; place++) {
        if (height_at(walk, place) >= least) {
            best.first = best.count == 0 ? place : best.first;
            best.last = place;
            best.count++;
            best.sum += place;
        }
    }
    return best;
}

static uint64_t highest_q10(fuzzy_system_method_t method, const highest_t *best) {
    switch (method) {
    case FUZZY_SMALLEST_OF_MAXIMUM:
        return (uint64_t)(2u * best->first + 1u) << 10;
    case FUZZY_LARGEST_OF_MAXIMUM:
        return (uint64_t)(2u * best->last + 1u) << 10;
    default:
        return (((uint64_t)best->sum << 11) + best->count / 2u) / fuzzy_max(best->count, 1u) +
               (1u << 10);
    }
}

static bool by_area(walk_t *walk, int32_t *value) {
    const areas_t sums = areas_of(walk);
    if (sums.area == 0) {
        return false;
    }
    *value = value_of(walk, walk->output->method == FUZZY_BISECTOR
                                ? halfway_q10(walk, sums.area)
                                : ((sums.moment << 10) + sums.area / 2u) / sums.area);
    return true;
}

static bool by_height(walk_t *walk, int32_t *value) {
    const highest_t best = highest_of(walk);
    if (best.height == 0) {
        return false;
    }
    *value = value_of(walk, highest_q10((fuzzy_system_method_t)walk->output->method, &best));
    return true;
}

bool fuzzy_defuzzify(const fuzzy_system_t *table, uint32_t index, const fuzzy_work_t *work,
                     int32_t *value) {
    walk_t walk = {
        .table = table, .output = fuzzy_system_output(table, index), .index = index, .work = work};
    const bool is_by_area = walk.output->method <= FUZZY_BISECTOR;
    return is_by_area ? by_area(&walk, value) : by_height(&walk, value);
}
