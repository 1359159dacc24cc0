/* A feed-forward network (network.h): layers with tanh, the last one linear. */
#ifndef QUIESCE_NETWORK_CORE_H
#define QUIESCE_NETWORK_CORE_H

#include <math.h>

struct quiesce_layer {
    int inputs;
    int units;
    const double *weights; /* units rows of inputs */
    const double *biases;  /* units */
};

/* in: inputs of the first layer; out: units of the last; hidden: room for the two widest layers
 * but the last, side by side, widest values each. */
static inline void quiesce_network_run(const struct quiesce_layer *layers, int count,
                                       const double *in, double *out, double *hidden, int widest) {
    for (int l = 0; l < count; ++l) {
        const struct quiesce_layer *layer = layers + l;
        const int is_last = l + 1 == count;
        double *to = is_last ? out : hidden + (l % 2) * widest;
        for (int unit = 0; unit < layer->units; ++unit) {
            const double *weights = layer->weights + unit * layer->inputs;
            double sum = layer->biases[unit];
            for (int k = 0; k < layer->inputs; ++k) {
                sum += weights[k] * in[k];
            }
            to[unit] = is_last ? sum : tanh(sum);
        }
        in = to;
    }
}

#endif
