// Evaluates a fuzzy system over arrays: what Python calls.
#include "fuzzy_system.h"

/// in: input i at point k is in[i * points + k]; out and defaults likewise.
void many_system(const fuzzy_system_t *table, uint32_t points, const int32_t *in, int32_t *out,
                 uint32_t *defaults) {
    for (uint32_t k = 0; k < points; k++) {
        int32_t input[FUZZY_SYSTEM_MAX_INPUTS] = {0};
        int32_t output[FUZZY_MAX_OUTPUTS] = {0};
        for (uint32_t i = 0; i < table->inputs; i++) {
            input[i] = in[(uint64_t)i * points + k];
        }
        defaults[k] = fuzzy_system_evaluate(table, input, output);
        for (uint32_t i = 0; i < table->outputs; i++) {
            out[(uint64_t)i * points + k] = output[i];
        }
    }
}
