#include "network.h"

#include <array>
#include <cmath>

namespace quiesce {

namespace {

double unit_sum(const NetworkLayer &layer, std::size_t unit, const double *in) {
    const double *weights = layer.weights.data() + unit * layer.inputs;
    double sum = layer.biases[unit];
    for (std::size_t k = 0; k < layer.inputs; ++k) {
        sum += weights[k] * in[k];
    }
    return sum;
}

} // namespace

void Network::run(const double *in, double *out) const {
    std::array<double, kMostUnits> buffers[2];
    for (std::size_t l = 0; l < layers_.size(); ++l) {
        const NetworkLayer &layer = layers_[l];
        const bool is_last = l + 1 == layers_.size();
        double *to = is_last ? out : buffers[l % 2].data();
        for (std::size_t unit = 0; unit < layer.units; ++unit) {
            const double sum = unit_sum(layer, unit, in);
            to[unit] = is_last ? sum : std::tanh(sum);
        }
        in = to;
    }
}

} // namespace quiesce
