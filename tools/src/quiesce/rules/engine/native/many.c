// Evaluates an engine of the firmware over arrays: what Python calls.
#include "fuzzy.h"

/// in: input i at point k is in[i * points + k]; out and defaults likewise.
static void evaluate(fuzzy_function_t function, const fuzzy_table_t *table, uint32_t inputs,
                     uint32_t outputs, uint32_t points, const int32_t *in, int32_t *out,
                     uint32_t *defaults) {
    for (uint32_t k = 0; k < points; k++) {
        int32_t input[FUZZY_MAX_INPUTS] = {0};
        int32_t output[FUZZY_MAX_OUTPUTS] = {0};
        for (uint32_t i = 0; i < inputs; i++) {
            input[i] = in[(uint64_t)i * points + k];
        }
        defaults[k] = table ? fuzzy_evaluate(table, input, output) : function(input, output);
        for (uint32_t i = 0; i < outputs; i++) {
            out[(uint64_t)i * points + k] = output[i];
        }
    }
}

void many_table(const fuzzy_table_t *table, uint32_t points, const int32_t *in, int32_t *out,
                uint32_t *defaults) {
    evaluate(0, table, table->inputs, table->outputs, points, in, out, defaults);
}

void many_function(fuzzy_function_t function, uint32_t inputs, uint32_t outputs, uint32_t points,
                   const int32_t *in, int32_t *out, uint32_t *defaults) {
    evaluate(function, 0, inputs, outputs, points, in, out, defaults);
}

void many_fired(const fuzzy_table_t *table, uint32_t points, const int32_t *in, uint64_t *fired) {
    for (uint32_t k = 0; k < points; k++) {
        int32_t input[FUZZY_MAX_INPUTS] = {0};
        for (uint32_t i = 0; i < table->inputs; i++) {
            input[i] = in[(uint64_t)i * points + k];
        }
        (void)fuzzy_fired(table, input, &fired[k]);
    }
}
