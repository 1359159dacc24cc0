#include "fuzzy_forms.h"

// Memberships of all inputs, rows of 8 as in a condition's byte.
typedef struct {
    uint32_t of[FUZZY_MAX_INPUTS * 8u];
} memberships_t;

// A table that has passed its check holds nothing beyond these. One that was damaged since must not
// lead a write out of what it belongs to: until that is noticed anything else might change.
static uint32_t inputs_of(const fuzzy_table_t *table) {
    return fuzzy_min(table->inputs, FUZZY_MAX_INPUTS);
}

static uint32_t outputs_of(const fuzzy_table_t *table) {
    return fuzzy_min(table->outputs, FUZZY_MAX_OUTPUTS);
}

typedef struct {
    uint64_t weighted;
    uint64_t strength;
} sums_t;

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
    const uint32_t inputs = inputs_of(table);
    for (uint32_t i = 0; i < 8u * inputs; i++) {
        out->of[i] = 0;
    }
    for (uint32_t i = 0; i < inputs; i++) {
        const fuzzy_cell_t *cell = find_cell(table, i, input[i]);
        const fuzzy_ramp_t *ramp = (const fuzzy_ramp_t *)(const void *)(cell + 1);
        const uint32_t distance = fuzzy_distance(cell, input[i]);
        for (uint32_t k = 0; k < cell->ramps; k++) {
            out->of[8u * i + ramp[k].set % 8u] = fuzzy_membership(&ramp[k], distance);
        }
    }
}

static const fuzzy_rule_t *rules_of(const fuzzy_table_t *table) {
    return fuzzy_at(table, table->rules_offset);
}

// Of all conditions together, before the weight.
static uint32_t rule_membership(const fuzzy_rule_t *rule, const memberships_t *memberships,
                                uint32_t one) {
    const bool is_or = (rule->head >> 20 & 1u) != 0;
    const uint32_t count = rule->head >> 24;
    uint32_t result = is_or ? 0 : one;
    for (uint32_t k = 0; k < count && (is_or || result != 0); k++) {
        const uint32_t condition = rule->condition[k];
        const uint32_t direct = memberships->of[condition & 31u];
        const uint32_t here = condition >> 7 != 0 ? one - direct : direct;
        result = is_or ? fuzzy_max(result, here) : fuzzy_min(result, here);
    }
    return result;
}

static uint32_t weight_q19(const fuzzy_rule_t *rule) {
    return rule->head & FUZZY_WEIGHT_MASK;
}

static uint32_t weight_exponent(const fuzzy_rule_t *rule) {
    return FUZZY_EXPONENT_STEP * (rule->head >> 21 & 7u);
}

static uint64_t strength_of(const fuzzy_table_t *table, const fuzzy_rule_t *rule,
                            const memberships_t *memberships) {
    const uint32_t membership = rule_membership(rule, memberships, table->one);
    return membership == 0
               ? 0
               : fuzzy_strength(membership, weight_q19(rule),
                                FUZZY_STRENGTH_SHIFT(table->rules) + weight_exponent(rule));
}

static void add_singleton(sums_t *sums, uint64_t strength, uint32_t singleton) {
    sums->weighted += strength * singleton;
    sums->strength += strength;
}

static sums_t sum_by_rule(const fuzzy_table_t *table, const fuzzy_output_t *output, uint32_t index,
                          const memberships_t *memberships) {
    const uint32_t *singleton = fuzzy_at(table, output->terms_offset);
    const fuzzy_rule_t *rule = rules_of(table);
    sums_t sums = {0};
    for (uint32_t i = 0; i < table->rules; i++) {
        const uint32_t term = rule[i].conclusion[index];
        if (term != FUZZY_NO_TERM) {
            add_singleton(&sums, strength_of(table, &rule[i], memberships), singleton[term]);
        }
    }
    return sums;
}

static sums_t sum_by_term(const fuzzy_table_t *table, const fuzzy_output_t *output, uint32_t index,
                          const memberships_t *memberships) {
    const uint32_t *singleton = fuzzy_at(table, output->terms_offset);
    const fuzzy_rule_t *rule = rules_of(table);
    uint64_t strongest[FUZZY_MAX_TERMS] = {0};
    for (uint32_t i = 0; i < table->rules; i++) {
        const uint32_t term = rule[i].conclusion[index];
        if (term != FUZZY_NO_TERM) {
            uint64_t *known = &strongest[term % FUZZY_MAX_TERMS];
            *known = fuzzy_max_u64(*known, strength_of(table, &rule[i], memberships));
        }
    }
    sums_t sums = {0};
    for (uint32_t i = 0; i < output->terms; i++) {
        add_singleton(&sums, strongest[i], singleton[i]);
    }
    return sums;
}

static uint32_t average(const fuzzy_output_t *output, sums_t sums, int32_t *value) {
    if (sums.strength == 0) {
        *value = output->value_default;
        return 1;
    }
    *value =
        output->origin + (int32_t)fuzzy_quotient(sums.weighted, sums.strength << output->fraction);
    return 0;
}

static uint32_t centroid(const fuzzy_table_t *table, const fuzzy_output_t *output, uint32_t index,
                         const memberships_t *memberships, int32_t *value) {
    const fuzzy_rule_t *rule = rules_of(table);
    uint64_t strongest[FUZZY_STRENGTHS] = {0};
    for (uint32_t i = 0; i < table->rules; i++) {
        const uint32_t term = rule[i].conclusion[index];
        if (term != FUZZY_NO_TERM) {
            const uint32_t membership = rule_membership(&rule[i], memberships, table->one);
            uint64_t *known = &strongest[term % FUZZY_STRENGTHS];
            *known = fuzzy_max_u64(*known, fuzzy_fine_strength(membership, weight_q19(&rule[i]),
                                                               weight_exponent(&rule[i])));
        }
    }
    return fuzzy_any_centroid(table, output, strongest, value);
}

static uint32_t evaluate_output(const fuzzy_table_t *table, uint32_t index,
                                const memberships_t *memberships, int32_t *value) {
    const fuzzy_output_t *output = fuzzy_output_of(table, index);
    switch (output->method) {
    case FUZZY_SUM:
        return average(output, sum_by_rule(table, output, index, memberships), value);
    case FUZZY_MAX:
        return average(output, sum_by_term(table, output, index, memberships), value);
    default:
        return centroid(table, output, index, memberships, value);
    }
}

// Apart from the dispatch, so that a partition does not pay for its stack.
__attribute__((noinline)) static uint32_t evaluate_any(const fuzzy_table_t *table,
                                                       const int32_t *input, int32_t *value) {
    memberships_t memberships;
    find_memberships(table, input, &memberships);
    uint32_t is_default = 0;
    for (uint32_t i = 0; i < outputs_of(table); i++) {
        is_default |= evaluate_output(table, i, &memberships, &value[i]) << i;
    }
    return is_default;
}

// Apart as well: one more case would be a table of jumps, which costs a partition two instructions.
__attribute__((noinline)) static uint32_t evaluate_rest(const fuzzy_table_t *table,
                                                        const int32_t *input, int32_t *value) {
    return table->form == FUZZY_SURFACE ? fuzzy_surface(table, input, value)
                                        : evaluate_any(table, input, value);
}

uint32_t fuzzy_evaluate(const fuzzy_table_t *table, const int32_t *input, int32_t *output) {
    switch (table->form) {
    case FUZZY_PARTITION_SUM:
        return fuzzy_partition_sum(table, input, output);
    case FUZZY_PARTITION_MAX:
        return fuzzy_partition_max(table, input, output);
    case FUZZY_PARTITION_CENTROID:
        return fuzzy_partition_centroid(table, input, output);
    default:
        return evaluate_rest(table, input, output);
    }
}

uint32_t fuzzy_fired(const fuzzy_table_t *table, const int32_t *input, uint64_t *fired) {
    *fired = 0;
    if (table->form == FUZZY_SURFACE) {
        return 0;
    }
    memberships_t memberships;
    find_memberships(table, input, &memberships);
    const fuzzy_rule_t *rule = rules_of(table);
    uint32_t count = 0;
    for (uint32_t i = 0; i < table->rules; i++) {
        if (strength_of(table, &rule[i], &memberships) != 0) {
            *fired |= i < 64u ? UINT64_C(1) << i : 0;
            count++;
        }
    }
    return count;
}
