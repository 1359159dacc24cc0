#include "fuzzy_system_forms.h"

enum { SPARE_OF_TERMS = 5 }; // up to 32 of up to four each

static void find_memberships(const fuzzy_system_t *table, const int32_t *input,
                             fuzzy_work_t *work) {
    const fuzzy_system_input_t *variable = fuzzy_system_at(table, table->inputs_offset);
    const uint32_t inputs = fuzzy_min(table->inputs, FUZZY_SYSTEM_MAX_INPUTS);
    for (uint32_t i = 0; i < inputs; i++) {
        work->input[i] = clamp_i32(input[i], variable[i].least, variable[i].most);
        const fuzzy_curve_t *curve = fuzzy_system_at(table, variable[i].terms_offset);
        for (uint32_t k = 0; k < variable[i].terms; k++) {
            work->membership_q30[(variable[i].first + k) % FUZZY_SYSTEM_ALL_TERMS] =
                fuzzy_curve_at(table, curve[k], variable[i].least, work->input[i]);
        }
    }
}

// What a push op pushes.
static uint32_t pushed(const fuzzy_work_t *work, uint32_t op) {
    const uint32_t number = op % FUZZY_SYSTEM_ALL_TERMS;
    switch (op >> 12) {
    case FUZZY_OP_INPUT:
        return work->membership_q30[number];
    case FUZZY_OP_OUTPUT:
        return fuzzy_min(work->term_q30[number], FUZZY_ONE_q30);
    default:
        return FUZZY_ONE_q30;
    }
}

static uint32_t expression(const fuzzy_system_t *table, const fuzzy_system_rule_t *rule,
                           const fuzzy_work_t *work) {
    const fuzzy_block_t *block = fuzzy_system_block(table, rule->block);
    const uint16_t *ops = fuzzy_rule_ops(rule);
    uint32_t stack[FUZZY_SYSTEM_MAX_STACK + 1u] = {0};
    uint32_t top = 0; // place 0 stays empty
    for (uint32_t i = 0; i < rule->ops; i++) {
        const uint32_t code = ops[i] >> 12;
        if (code < FUZZY_OP_HEDGE) {
            top = top < FUZZY_SYSTEM_MAX_STACK ? top + 1u : top;
            stack[top] = pushed(work, ops[i]);
        } else if (code == FUZZY_OP_HEDGE) {
            stack[top] = fuzzy_hedge((fuzzy_hedge_t)(ops[i] & 15u), stack[top]);
        } else if (top > 1u) {
            const uint32_t norm = code == FUZZY_OP_AND ? block->and_norm : block->or_norm;
            stack[top - 1u] = fuzzy_norm((fuzzy_norm_t)norm, stack[top - 1u], stack[top]);
            top--;
        }
    }
    return fuzzy_min(stack[top], FUZZY_ONE_q30);
}

static int32_t curve_value(const fuzzy_system_t *table, const fuzzy_value_t *value, int32_t least,
                           int32_t x) {
    const int64_t part = (int64_t)value->span * fuzzy_curve_at(table, value->curve, least, x);
    return value->value + (int32_t)((part + (1 << 29)) >> 30);
}

static int32_t linear_value(const fuzzy_system_t *table, const fuzzy_value_t *value,
                            const fuzzy_work_t *work) {
    const fuzzy_system_input_t *variable = fuzzy_system_at(table, table->inputs_offset);
    const int32_t *slope = fuzzy_system_at(table, value->slopes_offset);
    int64_t sum = 0;
    for (uint32_t i = 0; i < table->inputs; i++) {
        sum +=
            (int64_t)slope[i] * (int32_t)((uint32_t)work->input[i] - (uint32_t)variable[i].least);
    }
    return value->value + (int32_t)(sum >> value->shift);
}

// Value of an output's term, counts x 2^fraction, with a strength.
static int32_t value_at(const fuzzy_system_t *table, const fuzzy_system_output_t *output,
                        uint32_t term, const fuzzy_work_t *work, uint32_t strength_q30) {
    const fuzzy_value_t *value =
        (const fuzzy_value_t *)fuzzy_system_at(table, output->terms_offset) + term;
    switch (value->kind) {
    case FUZZY_VALUE_LINEAR:
        return linear_value(table, value, work);
    case FUZZY_VALUE_FORMULA:
        return fuzzy_formula_at(table, value, work);
    case FUZZY_VALUE_OF_STRENGTH:
    case FUZZY_PRODUCT_OF_STRENGTH:
        return curve_value(table, value, 0, (int32_t)strength_q30);
    case FUZZY_VALUE_OF_INPUT:
    case FUZZY_PRODUCT_OF_INPUT: {
        const fuzzy_system_input_t *variable = fuzzy_system_at(table, table->inputs_offset);
        const uint32_t i = value->input % FUZZY_SYSTEM_MAX_INPUTS;
        return curve_value(table, value, variable[i].least, work->input[i]);
    }
    default:
        return value->value;
    }
}

// Strength x value, 2^-spare of it.
static int64_t weighted_value(const fuzzy_system_t *table, const fuzzy_system_output_t *output,
                              uint32_t term, const fuzzy_work_t *work, uint32_t strength_q30,
                              uint32_t spare) {
    const fuzzy_value_t *value =
        (const fuzzy_value_t *)fuzzy_system_at(table, output->terms_offset) + term;
    const bool is_product =
        value->kind == FUZZY_PRODUCT_OF_INPUT || value->kind == FUZZY_PRODUCT_OF_STRENGTH;
    const int64_t factor = is_product ? INT64_C(1) << 30 : (int64_t)strength_q30;
    const int32_t found =
        value_at(table, output, term, work, fuzzy_min(strength_q30, FUZZY_ONE_q30));
    return (factor >> spare) * found;
}

static void activate(const fuzzy_system_t *table, uint32_t conclusion, uint32_t strength_q30,
                     fuzzy_work_t *work) {
    const uint32_t index = fuzzy_concluded_output(conclusion);
    const uint32_t term = conclusion & 255u;
    const fuzzy_system_output_t *output = fuzzy_system_output(table, index);
    fuzzy_activation_t *activation = &work->activation[index];
    if (output->method == FUZZY_BY_RULE || output->method == FUZZY_WEIGHTED) {
        const uint32_t spare = fuzzy_spare_bits(table);
        activation->weighted += weighted_value(table, output, term, work, strength_q30, spare);
        activation->strength += strength_q30 >> spare;
    }
    uint32_t *known = &work->term_q30[fuzzy_term_number(output, term)];
    *known = fuzzy_norm((fuzzy_norm_t)output->aggregation, *known, strength_q30);
}

static void fire(const fuzzy_system_t *table, const fuzzy_system_rule_t *rule,
                 uint32_t strength_q30, fuzzy_work_t *work) {
    const uint16_t *conclusion = fuzzy_rule_conclusions(rule);
    uint32_t hedged_q30 = strength_q30;
    for (uint32_t i = 0; strength_q30 != 0 && i < rule->conclusions; i++) {
        hedged_q30 = fuzzy_hedged(conclusion[i], strength_q30, hedged_q30);
        if ((conclusion[i] & FUZZY_ONLY_HEDGE) == 0) {
            activate(table, conclusion[i], hedged_q30, work);
        }
    }
}

static void apply_rules(const fuzzy_system_t *table, fuzzy_work_t *work) {
    const fuzzy_system_rule_t *rule = fuzzy_system_at(table, table->rules_offset);
    for (uint32_t i = 0; i < table->rules; i++) {
        const uint32_t strength_q30 =
            fuzzy_product_q30(expression(table, rule, work), rule->weight_q30);
        if (i < FUZZY_SYSTEM_LISTED) {
            work->strength_q30[i] = strength_q30;
        }
        fire(table, rule, strength_q30, work);
        rule = fuzzy_next_rule(rule);
    }
}

// Sum of strengths x values over terms.
static void weigh_terms(const fuzzy_system_t *table, const fuzzy_system_output_t *output,
                        uint32_t index, fuzzy_work_t *work) {
    fuzzy_activation_t *activation = &work->activation[index];
    for (uint32_t k = 0; k < output->terms; k++) {
        const uint32_t strength_q30 = work->term_q30[fuzzy_term_number(output, k)];
        if (strength_q30 != 0) {
            activation->weighted +=
                weighted_value(table, output, k, work, strength_q30, SPARE_OF_TERMS);
            activation->strength += strength_q30 >> SPARE_OF_TERMS;
        }
    }
}

// numerator / denominator, to nearest, halves away from zero.
static int64_t nearest_quotient(int64_t numerator, int64_t denominator) {
    const int64_t half = denominator / 2;
    return numerator >= 0 ? (numerator + half) / denominator : -((half - numerator) / denominator);
}

static int32_t counts_of(const fuzzy_system_output_t *output, int64_t value) {
    const int64_t half = output->fraction == 0 ? 0 : INT64_C(1) << (output->fraction - 1u);
    const int64_t counts = ((value + half) >> output->fraction) + output->offset;
    return output->span == 0
               ? (int32_t)clamp_i64(counts, INT32_MIN, INT32_MAX)
               : (int32_t)clamp_i64(counts, output->origin, (int64_t)output->origin + output->span);
}

static bool weigh(const fuzzy_system_t *table, uint32_t index, fuzzy_work_t *work, int32_t *value) {
    const fuzzy_system_output_t *output = fuzzy_system_output(table, index);
    const fuzzy_activation_t *activation = &work->activation[index];
    if (output->method == FUZZY_BY_TERM) {
        weigh_terms(table, output, index, work);
    }
    if (activation->strength == 0) {
        return false;
    }
    const int64_t divisor = output->method == FUZZY_WEIGHTED
                                ? INT64_C(1) << (30u - fuzzy_spare_bits(table))
                                : (int64_t)activation->strength;
    *value = counts_of(output, nearest_quotient(activation->weighted, divisor));
    return true;
}

uint32_t fuzzy_system_evaluate(const fuzzy_system_t *table, const int32_t *input, int32_t *output) {
    fuzzy_work_t work = {0};
    uint32_t is_default = 0;
    find_memberships(table, input, &work);
    apply_rules(table, &work);
    const uint32_t outputs = fuzzy_min(table->outputs, FUZZY_MAX_OUTPUTS);
    for (uint32_t i = 0; i < outputs; i++) {
        const fuzzy_system_output_t *one = fuzzy_system_output(table, i);
        const bool is_found = fuzzy_has_sets(one) ? fuzzy_defuzzify(table, i, &work, &output[i])
                                                  : weigh(table, i, &work, &output[i]);
        if (!is_found) {
            output[i] = one->value_default;
            is_default |= UINT32_C(1) << i;
        }
        work.output[i] = output[i];
    }
    return is_default;
}
