// Centroid of any output: strengths as weak as they like, sets in any arrangement.
#include "fuzzy_forms.h"

typedef struct {
    fuzzy_wide_sums_t more;
    fuzzy_wide_sums_t less;
} wide_balance_t;

// How high what lies between two sets that overlap is filled.
static uint64_t between(const fuzzy_layer_t *layer, const uint64_t *strength) {
    uint64_t most = 0;
    for (uint32_t i = layer->first + 1u; i < layer->second; i++) {
        most = fuzzy_max_u64(most, strength[i]);
    }
    return most;
}

// bits: of beta; the layer's heights have FUZZY_FINE_BITS less.
static void add_wide_layer(const fuzzy_layer_t *layer, uint32_t bits, uint64_t beta,
                           fuzzy_wide_sums_t *to, fuzzy_wide_sums_t *from) {
    const uint64_t start = (uint64_t)layer->start << FUZZY_FINE_BITS;
    const uint64_t most = (uint64_t)layer->height << FUZZY_FINE_BITS;
    const uint64_t height = beta <= start ? 0 : fuzzy_min_u64(beta - start, most);
    fuzzy_add_wide_area(to, layer->flanks, layer->steep, bits, height);
    fuzzy_add_wide_skew((layer->marks & FUZZY_SKEWED_LEFT) != 0 ? from : to, layer->flanks,
                        layer->steep, bits, height);
}

// Sets in any arrangement, one stretch of the output after the other: in a stretch no set crosses
// another, and from the highest down each adds what its strength exceeds those above it.
static uint32_t stacked_centre(const fuzzy_table_t *table, const fuzzy_output_t *output,
                               const fuzzy_layer_t *layer, const uint64_t *strength) {
    const uint32_t bits = table->bits + FUZZY_FINE_BITS;
    wide_balance_t sums = {{0, 0}, {0, 0}};
    uint64_t lower = 0;
    uint64_t upper = 0;
    for (uint32_t i = 0; i < output->layers; i++, layer++) {
        if ((layer->marks & FUZZY_BEGINS_STRETCH) != 0) {
            upper = 0;
        }
        if ((layer->marks & FUZZY_BEGINS_SET) != 0) {
            lower = upper;
            upper = fuzzy_max_u64(upper, strength[layer->first]);
        }
        if (upper > lower) {
            add_wide_layer(layer, bits, upper, &sums.more, &sums.less);
            add_wide_layer(layer, bits, lower, &sums.less, &sums.more);
        }
    }
    return fuzzy_wide_centre(sums.more, sums.less, output->span);
}

static uint32_t ordered_centre(const fuzzy_table_t *table, const fuzzy_output_t *output,
                               const fuzzy_layer_t *layer, const uint64_t *strength) {
    const uint32_t bits = table->bits + FUZZY_FINE_BITS;
    wide_balance_t sums = {{0, 0}, {0, 0}};
    for (uint32_t i = 0; i < output->layers; i++, layer++) {
        const uint64_t upper = fuzzy_min_u64(strength[layer->first], strength[layer->second]);
        const uint64_t lower = between(layer, strength);
        if (layer->first == layer->second) {
            add_wide_layer(layer, bits, upper, &sums.more, &sums.less);
        } else if (upper > lower) {
            add_wide_layer(layer, bits, upper, &sums.less, &sums.more);
            add_wide_layer(layer, bits, lower, &sums.more, &sums.less);
        }
    }
    return fuzzy_wide_centre(sums.more, sums.less, output->span);
}

uint32_t fuzzy_any_centroid(const fuzzy_table_t *table, const fuzzy_output_t *output,
                            uint64_t *strength, int32_t *value) {
    const uint32_t *peak = fuzzy_at(table, output->terms_offset);
    uint64_t strongest = 0;
    for (uint32_t i = 0; i < output->terms && i < FUZZY_STRENGTHS; i++) {
        strength[i] = fuzzy_min_u64(strength[i], (uint64_t)peak[i] << FUZZY_FINE_BITS);
        strongest = fuzzy_max_u64(strongest, strength[i]);
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
