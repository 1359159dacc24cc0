/// A network over what the damper sees now: no memory.
///
///   F = force_scale N(i, x, v, T), inputs scaled to -1 .. 1 over the ranges of the training
#ifndef QUIESCE_STATIC_NETWORK_H
#define QUIESCE_STATIC_NETWORK_H

#include "input_box.h"
#include "network.h"

namespace quiesce {

class StaticNetwork final : public StaticDamper {
  public:
    /// network: as many inputs as the box, one output.
    StaticNetwork(InputBox box, double stroke_m, Network network, double force_scale_N)
        : StaticDamper(std::move(box), stroke_m), network_(std::move(network)),
          force_scale_N_(force_scale_N) {}

    double force_N(const DamperInput &input, const double * /*state*/,
                   double * /*rates*/) const override {
        const Inputs in = box().scaled(input);
        double out = 0.0;
        network_.run(in.data(), &out);
        return force_scale_N_ * out;
    }

  private:
    Network network_;
    double force_scale_N_;
};

} // namespace quiesce

#endif
