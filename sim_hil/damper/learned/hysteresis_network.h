/// A network over the states of simple hysteresis elements, all in continuous time: a black box
/// that runs at any step and needs no measured force.
///
///   coil      c_j' = (i - c_j) / tau_j                              A
///   elastic   r_j' = v - r_j / tau_j                                m    (spring and dashpot)
///   chain     g_1' = (v - g_1) / tau,  g_k' = (g_(k-1) - g_k) / tau m/s  (earlier velocities)
///   stop      w_j' = (v - |v| w_j) / reach_j                        -1 .. 1 (spring and slider)
///   features  p = clip((x, v, [a], c, r, g, w) - mean) / scale
///   force     F = force_scale sum_k s^k (N_k(p) + skip_k p),  s = c_1 / current_scale
///
/// N has one layer with tanh. Without coil times s is the current itself and no feature.
#ifndef QUIESCE_HYSTERESIS_NETWORK_H
#define QUIESCE_HYSTERESIS_NETWORK_H

#include <vector>

#include "damper.h"
#include "network.h"

namespace quiesce {

struct HysteresisNetworkParams {
    double stroke_m;        ///< > 0; the model ends at -stroke_m
    double speed_m_s;       ///< > 0; the largest that is expected
    double force_scale_N;   ///< > 0
    double current_scale_A; ///< > 0
    bool uses_accel;
    std::vector<double> coil_times_s;    ///< each > 0, as the following; may be empty
    std::vector<double> elastic_times_s; ///< may be empty
    double chain_time_s;
    std::size_t chain_count;
    std::vector<double> stop_reaches_m; ///< may be empty
    std::vector<double> means;          ///< one a feature
    std::vector<double> scales;         ///< one a feature, > 0
    double clip;                        ///< > 0, of the scaled features
    std::vector<double> skip;           ///< a row of features for each power of s
};

/// Features that these elements make.
std::size_t feature_count(const HysteresisNetworkParams &params);

class HysteresisNetwork final : public Damper {
  public:
    /// network: from the features to one output for each power of s, from 0 on.
    HysteresisNetwork(HysteresisNetworkParams params, Network network);

    std::size_t state_count() const override;
    double force_N(const DamperInput &input, const double *state, double *rates) const override;
    double stiffest_N_s_m(double current_A) const override;
    double stiffest_N_m(double current_A) const override;
    double fastest_rate_1_s(double current_A) const override;
    bool uses_accel() const override { return params_.uses_accel; }
    double lowest_position_m() const override { return -params_.stroke_m; }

  private:
    void write_rates(const DamperInput &input, const double *state, double *rates) const;
    std::vector<double> features(const DamperInput &input, const double *state) const;
    std::vector<double> quick_state(double moved_m, double current_A) const;

    HysteresisNetworkParams params_;
    Network network_;
};

} // namespace quiesce

#endif
