/// A network over delayed copies of what the damper sees and, where it is recurrent, over its own
/// earlier forces; it runs at a sample time of its own and holds the force in between.
///
///   F[k] = force_scale N(inputs[k - lag] for each lag; F[k - lag] / force_scale for each feedback)
///
/// Where there is a quadrature, its features stand behind the inputs of every lag.
///
/// The state is the time since the last sample, whether there was one, the force held, and the
/// delayed values; it changes in after_step, not by integration.
#ifndef QUIESCE_SAMPLED_NETWORK_H
#define QUIESCE_SAMPLED_NETWORK_H

#include <optional>
#include <vector>

#include "input_box.h"
#include "network.h"
#include "sampled_network_core.h"

namespace quiesce {

struct SampledNetworkParams {
    double stroke_m;           ///< > 0; the model ends at -stroke_m
    double sample_time_s;      ///< > 0
    double force_scale_N;      ///< > 0
    std::vector<int> lags;     ///< of the inputs, in samples, at least one, rising from >= 0
    std::vector<int> feedback; ///< of the force, rising from >= 1; may be empty
    std::optional<quiesce_quadrature> quadrature = std::nullopt;
};

class SampledNetwork final : public Damper {
  public:
    /// network: lags x (inputs + features) + feedback inputs, one output.
    SampledNetwork(InputBox box, SampledNetworkParams params, Network network);

    /// core_ points into it.
    SampledNetwork(const SampledNetwork &) = delete;
    SampledNetwork &operator=(const SampledNetwork &) = delete;

    std::size_t state_count() const override { return states_; }
    double force_N(const DamperInput &input, const double *state, double *rates) const override;
    void after_step(const DamperInput &input, double *state, double dt_s) const override;
    bool is_sampled() const override { return true; }
    double stiffest_N_s_m(double current_A) const override;
    double lowest_position_m() const override { return -params_.stroke_m; }

  private:
    quiesce_sampled core() const;
    void take_sample(const DamperInput &input, double *state) const;

    InputBox box_;
    SampledNetworkParams params_;
    Network network_;
    std::vector<double> low_;
    std::vector<double> high_;
    std::vector<quiesce_layer> layers_;
    quiesce_sampled core_ = {};
    std::size_t states_ = 0;
};

} // namespace quiesce

#endif
