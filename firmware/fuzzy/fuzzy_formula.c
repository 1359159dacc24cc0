#include "fuzzy_system_forms.h"

static int32_t limited(int64_t value) {
    return (int32_t)clamp_i64(value, -FUZZY_FORMULA_LIMIT, FUZZY_FORMULA_LIMIT);
}

static int64_t pushed(const fuzzy_system_t *table, const fuzzy_formula_op_t *op,
                      const fuzzy_work_t *work) {
    const fuzzy_system_input_t *variable = fuzzy_system_at(table, table->inputs_offset);
    const uint32_t i = op->number % FUZZY_SYSTEM_MAX_INPUTS;
    int64_t count = 0;
    if (op->code == FUZZY_FORMULA_INPUT) {
        count = (int64_t)work->input[i] - variable[i].least;
    } else if (op->code == FUZZY_FORMULA_OUTPUT) {
        count = work->output[op->number % FUZZY_MAX_OUTPUTS];
    }
    return op->value + ((count * op->span) >> op->left);
}

static int64_t of_one(const fuzzy_system_t *table, const fuzzy_formula_op_t *op, int32_t value) {
    if (op->code == FUZZY_FORMULA_ABSOLUTE) {
        return value < 0 ? -(int64_t)value : value;
    }
    const int64_t part =
        (int64_t)op->span * fuzzy_curve_at(table, op->curve, -FUZZY_FORMULA_LIMIT, value);
    return op->value + ((part + (1 << 29)) >> 30);
}

static int64_t of_two(const fuzzy_formula_op_t *op, int64_t first, int64_t second) {
    if (op->code == FUZZY_FORMULA_MULTIPLY) {
        return (first * second) >> op->left;
    }
    const int64_t a = first >> op->left;
    const int64_t b = second >> op->right;
    switch (op->code) {
    case FUZZY_FORMULA_ADD:
        return a + b;
    case FUZZY_FORMULA_SUBTRACT:
        return a - b;
    case FUZZY_FORMULA_LEAST:
        return a < b ? a : b;
    default:
        return a > b ? a : b;
    }
}

int32_t fuzzy_formula_at(const fuzzy_system_t *table, const fuzzy_value_t *value,
                         const fuzzy_work_t *work) {
    const fuzzy_formula_op_t *op = fuzzy_system_at(table, value->slopes_offset);
    int32_t stack[FUZZY_SYSTEM_MAX_STACK + 1u] = {0};
    uint32_t top = 0; // place 0 stays empty
    for (uint32_t i = 0; i < value->input; i++) {
        if (op[i].code < FUZZY_FORMULA_ADD) {
            top = top < FUZZY_SYSTEM_MAX_STACK ? top + 1u : top;
            stack[top] = limited(pushed(table, &op[i], work));
        } else if (op[i].code >= FUZZY_FORMULA_ABSOLUTE) {
            stack[top] = limited(of_one(table, &op[i], stack[top]));
        } else if (top > 1u) {
            stack[top - 1u] = limited(of_two(&op[i], stack[top - 1u], stack[top]));
            top--;
        }
    }
    const int64_t scaled = ((int64_t)stack[top] * value->span) >> value->shift;
    return (int32_t)clamp_i64(value->value + scaled, -FUZZY_SYSTEM_MAX_VALUE,
                              FUZZY_SYSTEM_MAX_VALUE);
}
