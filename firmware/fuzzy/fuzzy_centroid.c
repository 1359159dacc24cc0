// Centroid of any output: strengths as weak as they like, sets in any arrangement.
#include "fuzzy_forms.h"

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
        const uint32_t lower = fuzzy_between(layer, strength);
        if (layer->first == layer->second) {
            add_wide_layer(layer, table->bits, upper, &sums.more, &sums.less);
        } else if (upper > lower) {
            add_wide_layer(layer, table->bits, upper, &sums.less, &sums.more);
            add_wide_layer(layer, table->bits, lower, &sums.more, &sums.less);
        }
    }
    return fuzzy_wide_centre(sums.more, sums.less, output->span);
}

uint32_t fuzzy_any_centroid(const fuzzy_table_t *table, const fuzzy_output_t *output,
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
