#include "network.h"

#include <algorithm>
#include <array>

namespace quiesce {

std::vector<quiesce_layer> Network::core() const {
    std::vector<quiesce_layer> out;
    for (const NetworkLayer &layer : layers_) {
        out.push_back({static_cast<int>(layer.inputs), static_cast<int>(layer.units),
                       layer.weights.data(), layer.biases.data()});
    }
    return out;
}

std::size_t Network::widest() const {
    std::size_t most = 0;
    for (std::size_t k = 0; k + 1 < layers_.size(); ++k) {
        most = std::max(most, layers_[k].units);
    }
    return most;
}

void Network::run(const double *in, double *out) const {
    std::array<double, 2 * kMostUnits> hidden;
    const std::vector<quiesce_layer> layers = core();
    quiesce_network_run(layers.data(), static_cast<int>(layers.size()), in, out, hidden.data(),
                        kMostUnits);
}

} // namespace quiesce
