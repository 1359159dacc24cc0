/// A feed-forward network: layers with tanh, the last one linear.
#ifndef QUIESCE_NETWORK_H
#define QUIESCE_NETWORK_H

#include <cstddef>
#include <vector>

#include "network_core.h"

namespace quiesce {

/// Widest layer.
constexpr std::size_t kMostUnits = 1024;

struct NetworkLayer {
    std::size_t inputs;
    std::size_t units;           ///< 1 .. kMostUnits
    std::vector<double> weights; ///< units rows of inputs
    std::vector<double> biases;  ///< units
};

class Network {
  public:
    /// At least one layer; each takes what the one before it gives.
    explicit Network(std::vector<NetworkLayer> layers) : layers_(std::move(layers)) {}

    std::size_t input_count() const { return layers_.front().inputs; }
    std::size_t output_count() const { return layers_.back().units; }
    /// Of its layers but the last; 0 where there is only that.
    std::size_t widest() const;

    /// in: input_count() values; out: output_count().
    void run(const double *in, double *out) const;

    /// As cores/ want them; they point into this network, which must outlive them.
    std::vector<quiesce_layer> core() const;

  private:
    std::vector<NetworkLayer> layers_;
};

} // namespace quiesce

#endif
