#include "fuzzy_system_forms.h"

#include "crc32.h"

#define CRC_FROM_WORD 2u
#define MAX_FRACTION 24u
#define MAX_SUM (INT64_C(1) << 61)
#define MAX_SHIFT 62u

static bool is_inside(const fuzzy_system_t *table, uint32_t offset, uint32_t words) {
    return offset >= FUZZY_HEADER_WORDS && offset <= table->size_words &&
           words <= table->size_words - offset;
}

static bool is_t_norm(uint32_t norm) {
    return norm < FUZZY_T_NORMS;
}

static bool is_s_norm(uint32_t norm) {
    return norm >= FUZZY_MAXIMUM && norm < FUZZY_S_NORMS_END;
}

static bool has_shape(const fuzzy_system_t *table) {
    return table->inputs != 0 && table->inputs <= FUZZY_SYSTEM_MAX_INPUTS && table->outputs != 0 &&
           table->outputs <= FUZZY_MAX_OUTPUTS && table->blocks != 0 && table->rules != 0 &&
           table->rules <= (table->is_listed != 0 ? FUZZY_SYSTEM_LISTED : FUZZY_MAX_RULES) &&
           is_inside(table, table->inputs_offset, 4u * table->inputs) &&
           is_inside(table, table->outputs_offset, 8u * table->outputs) &&
           is_inside(table, table->blocks_offset, table->blocks);
}

// ---- curves -------------------------------------------------------------------------------------

static bool is_small(int32_t slope_q24) {
    return slope_q24 >= -FUZZY_SYSTEM_MAX_SLOPE && slope_q24 <= FUZZY_SYSTEM_MAX_SLOPE;
}

// A piece of first .. last.
static bool is_piece_good(const int32_t *piece, bool is_cubic, int64_t first, int64_t last) {
    const uint32_t shift = (uint32_t)piece[1];
    const bool is_bent_well = !is_cubic || (is_small(piece[4]) && is_small(piece[5]));
    return first <= last && shift <= 31u && (uint64_t)(last - first) << shift < UINT64_C(1) << 31 &&
           is_small(piece[3]) && is_bent_well;
}

// low .. high: all that it is asked for.
static bool is_curve_good(const fuzzy_system_t *table, fuzzy_curve_t curve, int32_t low,
                          int32_t high) {
    const bool is_cubic = curve.degree == 3u;
    const uint32_t words = is_cubic ? FUZZY_CUBIC_WORDS : FUZZY_LINE_WORDS;
    if ((curve.degree != 1u && !is_cubic) || curve.pieces == 0 ||
        !is_inside(table, curve.offset, words * curve.pieces)) {
        return false;
    }
    const int32_t *piece = fuzzy_system_at(table, curve.offset);
    int64_t first = low;
    for (uint32_t i = 0; i < curve.pieces; i++, piece += words) {
        const int64_t last = i + 1u == curve.pieces ? high : piece[0];
        if (last > high || !is_piece_good(piece, is_cubic, first, last)) {
            return false;
        }
        first = last + 1;
    }
    return true;
}

static bool are_inputs_good(const fuzzy_system_t *table) {
    const fuzzy_system_input_t *input = fuzzy_system_at(table, table->inputs_offset);
    uint32_t all = 0;
    for (uint32_t i = 0; i < table->inputs; i++) {
        const uint32_t first = all;
        all += input[i].terms;
        if (input[i].least > input[i].most || input[i].terms > FUZZY_SYSTEM_MAX_TERMS ||
            input[i].first != first || all > FUZZY_SYSTEM_ALL_TERMS ||
            !is_inside(table, input[i].terms_offset, input[i].terms)) {
            return false;
        }
        const fuzzy_curve_t *curve = fuzzy_system_at(table, input[i].terms_offset);
        for (uint32_t k = 0; k < input[i].terms; k++) {
            if (!is_curve_good(table, curve[k], input[i].least, input[i].most)) {
                return false;
            }
        }
    }
    return true;
}

// ---- outputs ------------------------------------------------------------------------------------

static bool is_value(int64_t value) {
    return value >= -FUZZY_SYSTEM_MAX_VALUE && value <= FUZZY_SYSTEM_MAX_VALUE;
}

// At both ends of every input.
static bool is_linear_good(const fuzzy_system_t *table, const fuzzy_value_t *value) {
    if (!is_inside(table, value->slopes_offset, table->inputs) || value->shift > 31u) {
        return false;
    }
    const fuzzy_system_input_t *input = fuzzy_system_at(table, table->inputs_offset);
    const int32_t *slope = fuzzy_system_at(table, value->slopes_offset);
    int64_t least = 0;
    int64_t most = 0;
    for (uint32_t i = 0; i < table->inputs; i++) {
        const int64_t range = (int64_t)input[i].most - input[i].least;
        if (range > INT32_MAX || slope[i] < -INT32_MAX / 2 || slope[i] > INT32_MAX / 2) {
            return false;
        }
        const int64_t end = slope[i] * range;
        least += end < 0 ? end : 0;
        most += end > 0 ? end : 0;
        // Each end is within 2^61: sums that stay within it cannot overflow on the way.
        if (least < -MAX_SUM || most > MAX_SUM) {
            return false;
        }
    }
    return is_value(value->value + (least >> value->shift)) &&
           is_value(value->value + (most >> value->shift) + 1);
}

// Whether an op finds what it names; index: of the output that it is for.
static bool is_formula_op_good(const fuzzy_system_t *table, const fuzzy_formula_op_t *op,
                               uint32_t index) {
    const fuzzy_system_input_t *input = fuzzy_system_at(table, table->inputs_offset);
    if (op->code >= FUZZY_FORMULA_CODES || op->left > MAX_SHIFT || op->right > MAX_SHIFT) {
        return false;
    }
    switch (op->code) {
    case FUZZY_FORMULA_INPUT:
        return op->number < table->inputs &&
               (int64_t)input[op->number].most - input[op->number].least <= INT32_MAX;
    case FUZZY_FORMULA_OUTPUT:
        return op->number < index && fuzzy_system_output(table, index)->method == FUZZY_BY_TERM;
    case FUZZY_FORMULA_CURVE:
        return is_curve_good(table, op->curve, -FUZZY_FORMULA_LIMIT, FUZZY_FORMULA_LIMIT);
    default:
        return true;
    }
}

// Every op finds what it takes, and one value is left.
static bool is_formula_good(const fuzzy_system_t *table, const fuzzy_value_t *value,
                            uint32_t index) {
    const uint32_t ops = value->input;
    if (ops > FUZZY_FORMULA_OPS || value->shift > MAX_SHIFT ||
        !is_inside(table, value->slopes_offset, 4u * ops)) {
        return false;
    }
    const fuzzy_formula_op_t *op = fuzzy_system_at(table, value->slopes_offset);
    uint32_t depth = 0;
    for (uint32_t i = 0; i < ops; i++) {
        if (op[i].code < FUZZY_FORMULA_ADD) {
            depth++;
        } else if (op[i].code < FUZZY_FORMULA_ABSOLUTE) {
            depth = depth < 2u ? 0 : depth - 1u;
        }
        if (depth == 0 || depth > FUZZY_SYSTEM_MAX_STACK ||
            !is_formula_op_good(table, &op[i], index)) {
            return false;
        }
    }
    return depth == 1u;
}

static bool is_value_good(const fuzzy_system_t *table, const fuzzy_value_t *value, uint32_t index) {
    const fuzzy_system_input_t *input = fuzzy_system_at(table, table->inputs_offset);
    const bool has_ends = is_value(value->value) && is_value((int64_t)value->value + value->span);
    switch (value->kind) {
    case FUZZY_VALUE_CONSTANT:
        return is_value(value->value);
    case FUZZY_VALUE_LINEAR:
        return is_linear_good(table, value);
    case FUZZY_VALUE_FORMULA:
        return is_formula_good(table, value, index);
    case FUZZY_VALUE_OF_STRENGTH:
    case FUZZY_PRODUCT_OF_STRENGTH:
        return has_ends && is_curve_good(table, value->curve, 0, (int32_t)FUZZY_ONE_q30);
    case FUZZY_VALUE_OF_INPUT:
    case FUZZY_PRODUCT_OF_INPUT:
        return has_ends && value->input < table->inputs &&
               is_curve_good(table, value->curve, input[value->input].least,
                             input[value->input].most);
    default:
        return false;
    }
}

static bool are_values_good(const fuzzy_system_t *table, uint32_t index) {
    const fuzzy_system_output_t *output = fuzzy_system_output(table, index);
    const uint32_t most =
        output->method == FUZZY_BY_TERM ? FUZZY_SYSTEM_MAX_TERMS : FUZZY_SYSTEM_MAX_VALUES;
    if (output->terms > most || output->fraction > MAX_FRACTION ||
        !is_inside(table, output->terms_offset, 5u * output->terms)) {
        return false;
    }
    const fuzzy_value_t *value = fuzzy_system_at(table, output->terms_offset);
    for (uint32_t k = 0; k < output->terms; k++) {
        const bool is_weighed_once =
            value[k].kind != FUZZY_PRODUCT_OF_INPUT || output->method != FUZZY_BY_TERM;
        if (!is_weighed_once || !is_value_good(table, &value[k], index)) {
            return false;
        }
    }
    return true;
}

static bool are_sets_good(const fuzzy_system_t *table, const fuzzy_system_output_t *output) {
    if (output->terms > FUZZY_SYSTEM_MAX_TERMS || output->places < 2u ||
        output->places > FUZZY_SYSTEM_MAX_PLACES || !is_t_norm(output->implication) ||
        (output->is_by_rule != 0 && table->is_listed == 0) ||
        !is_inside(table, output->terms_offset, output->terms)) {
        return false;
    }
    const fuzzy_curve_t *curve = fuzzy_system_at(table, output->terms_offset);
    for (uint32_t k = 0; k < output->terms; k++) {
        if (!is_curve_good(table, curve[k], 0, (int32_t)FUZZY_ONE_q30)) {
            return false;
        }
    }
    return true;
}

static bool are_outputs_good(const fuzzy_system_t *table) {
    uint32_t all = 0;
    for (uint32_t i = 0; i < table->outputs; i++) {
        const fuzzy_system_output_t *output = fuzzy_system_output(table, i);
        const uint32_t first = all;
        all += output->terms;
        if (output->first != first || all > FUZZY_SYSTEM_ALL_TERMS ||
            output->method >= FUZZY_SYSTEM_METHODS || !is_s_norm(output->aggregation) ||
            output->terms == 0 || (int64_t)output->origin + output->span > INT32_MAX ||
            !(fuzzy_has_sets(output) ? are_sets_good(table, output) : are_values_good(table, i))) {
            return false;
        }
    }
    return true;
}

// ---- rules --------------------------------------------------------------------------------------

static bool are_blocks_good(const fuzzy_system_t *table) {
    for (uint32_t i = 0; i < table->blocks; i++) {
        const fuzzy_block_t *block = fuzzy_system_block(table, i);
        if (!is_t_norm(block->and_norm) || !is_s_norm(block->or_norm) ||
            block->or_norm == FUZZY_UNBOUNDED_SUM || !is_t_norm(block->implication)) {
            return false;
        }
    }
    return true;
}

static bool is_condition_good(const fuzzy_system_t *table, uint32_t op) {
    const uint32_t number = op & 0xFFFu;
    if (op >> 12 == FUZZY_OP_INPUT) {
        const fuzzy_system_input_t *input = fuzzy_system_at(table, table->inputs_offset);
        const fuzzy_system_input_t *last = &input[table->inputs - 1u];
        return number < (uint32_t)last->first + last->terms;
    }
    if (op >> 12 == FUZZY_OP_OUTPUT) {
        const fuzzy_system_output_t *last = fuzzy_system_output(table, table->outputs - 1u);
        return number < (uint32_t)last->first + last->terms;
    }
    return true;
}

// Every op finds what it takes, and one value is left.
static bool are_ops_good(const fuzzy_system_t *table, const fuzzy_system_rule_t *rule) {
    const uint16_t *ops = fuzzy_rule_ops(rule);
    uint32_t depth = 0;
    for (uint32_t i = 0; i < rule->ops; i++) {
        const uint32_t code = ops[i] >> 12;
        if (code < FUZZY_OP_HEDGE) {
            depth++;
        } else if (code == FUZZY_OP_AND || code == FUZZY_OP_OR) {
            depth = depth < 2u ? 0 : depth - 1u;
        }
        const bool is_hedge_good = code != FUZZY_OP_HEDGE || (ops[i] & 0xFFFu) < FUZZY_HEDGES;
        if (depth == 0 || depth > FUZZY_SYSTEM_MAX_STACK || code >= FUZZY_OPS || !is_hedge_good ||
            !is_condition_good(table, ops[i])) {
            return false;
        }
    }
    return depth == 1u;
}

static bool is_conclusion_good(const fuzzy_system_t *table, uint32_t conclusion, uint32_t named) {
    const uint32_t index = fuzzy_concluded_output(conclusion);
    return index < table->outputs && (named >> index & 1u) == 0 &&
           (conclusion & 255u) < fuzzy_system_output(table, index)->terms;
}

// Each output at most once, so that sums stay within their words.
static bool are_conclusions_good(const fuzzy_system_t *table, const fuzzy_system_rule_t *rule) {
    const uint16_t *conclusion = fuzzy_rule_conclusions(rule);
    uint32_t named = 0;
    for (uint32_t i = 0; i < rule->conclusions; i++) {
        if (conclusion[i] >> 12 >= FUZZY_HEDGES) {
            return false;
        }
        if ((conclusion[i] & FUZZY_ONLY_HEDGE) == 0) {
            if (!is_conclusion_good(table, conclusion[i], named)) {
                return false;
            }
            named |= UINT32_C(1) << fuzzy_concluded_output(conclusion[i]);
        }
    }
    return named != 0;
}

// Of a rule that begins inside: both heads' words, then all of it.
static bool is_rule_good(const fuzzy_system_t *table, const fuzzy_system_rule_t *rule,
                         uint32_t offset) {
    if (!is_inside(table, offset, 2u)) {
        return false;
    }
    const uint32_t words = 2u + (rule->ops + 1u) / 2u + (rule->conclusions + 1u) / 2u;
    return is_inside(table, offset, words) && rule->block < table->blocks &&
           rule->weight_q30 <= FUZZY_ONE_q30 && are_ops_good(table, rule) &&
           are_conclusions_good(table, rule);
}

static bool are_rules_good(const fuzzy_system_t *table) {
    uint32_t offset = table->rules_offset;
    for (uint32_t i = 0; i < table->rules; i++) {
        const fuzzy_system_rule_t *rule = fuzzy_system_at(table, offset);
        if (!is_rule_good(table, rule, offset)) {
            return false;
        }
        offset += 2u + (rule->ops + 1u) / 2u + (rule->conclusions + 1u) / 2u;
    }
    return true;
}

static fuzzy_verdict_t sections(const fuzzy_system_t *table) {
    if (!has_shape(table)) {
        return FUZZY_TABLE_SHAPE;
    }
    if (!are_inputs_good(table)) {
        return FUZZY_TABLE_CELL;
    }
    if (!are_outputs_good(table)) {
        return FUZZY_TABLE_OUTPUT;
    }
    return are_blocks_good(table) && are_rules_good(table) ? FUZZY_TABLE_OK : FUZZY_TABLE_RULE;
}

fuzzy_verdict_t fuzzy_system_check(const fuzzy_system_t *table, uint32_t words) {
    if (words < FUZZY_HEADER_WORDS || words > FUZZY_MAX_WORDS || table->size_words != words) {
        return FUZZY_TABLE_SIZE;
    }
    if (table->magic != FUZZY_SYSTEM_MAGIC) {
        return FUZZY_TABLE_MAGIC;
    }
    const uint32_t *all = fuzzy_system_at(table, 0);
    if (table->crc != crc32_words(&all[CRC_FROM_WORD], words - CRC_FROM_WORD)) {
        return FUZZY_TABLE_CRC;
    }
    return sections(table);
}
