/// Networks over the states of simple hysteresis elements, all in continuous time: a black box that
/// runs at any step and needs no measured force. On top of another model it is a grey box.
///
///   coil      c_j' = (i - c_j) / tau_j, tau_j rising or falling     A
///   elastic   r_j' = v - r_j / tau_j                                m    (spring and dashpot)
///   chain     g_1' = (v - g_1) / tau_1,  g_k' = (g_(k-1) - g_k) / tau_k  m/s (earlier velocities)
///   stop      w_j' = (v - |v| w_j) / reach_j                        -1 .. 1 (spring and slider)
///   features  p = clip(((x, v, [a], c, r, g, w, [F_base]) - mean) / scale)
///   field     g = s^q (1 + K) / (K + s^q), s = c_1 / current_scale  (toe and saturation)
///   force     F = F_base + force_scale sum_k g^k (N_k(p) + skip_k p)
///
/// N is the mean of the member networks. The base sees c_1 as its current. Without coil times the
/// current itself takes the place of c_1 and is no feature.
#ifndef QUIESCE_HYSTERESIS_NETWORK_H
#define QUIESCE_HYSTERESIS_NETWORK_H

#include <memory>
#include <vector>

#include "damper.h"
#include "hysteresis_network_core.h"
#include "network.h"

namespace quiesce {

struct HysteresisNetworkParams {
    double stroke_m;        ///< > 0; the model ends at -stroke_m
    double speed_m_s;       ///< > 0; the largest that is expected
    double force_scale_N;   ///< > 0
    double current_scale_A; ///< > 0
    double field_exponent;  ///< q > 0
    double saturation;      ///< K > 0; large for none
    bool uses_accel;
    std::vector<double> coil_times_s;      ///< each > 0, as the following; may be empty
    std::vector<double> coil_fall_times_s; ///< as many
    std::vector<double> elastic_times_s;   ///< may be empty, as the following
    std::vector<double> chain_times_s;
    std::vector<double> stop_reaches_m;
    std::vector<double> means;          ///< one a feature
    std::vector<double> scales;         ///< one a feature, > 0
    double clip;                        ///< > 0, of the scaled features
    std::vector<double> skip;           ///< a row of features for each power of g
    std::shared_ptr<const Damper> base; ///< or null
};

/// Features that these elements make.
std::size_t feature_count(const HysteresisNetworkParams &params);

class HysteresisNetwork final : public Damper {
  public:
    /// members: at least one, each from the features to one output for each power of g, from 0 on.
    HysteresisNetwork(HysteresisNetworkParams params, std::vector<Network> members);
    /// core_ points into it.
    HysteresisNetwork(const HysteresisNetwork &) = delete;
    HysteresisNetwork &operator=(const HysteresisNetwork &) = delete;

    std::size_t state_count() const override;
    double force_N(const DamperInput &input, const double *state, double *rates) const override;
    double stiffest_N_s_m(double current_A) const override;
    double stiffest_N_m(double current_A) const override;
    double fastest_rate_1_s(double current_A) const override;
    bool uses_accel() const override;
    double lowest_position_m() const override { return -params_.stroke_m; }

  private:
    quiesce_hysteresis core() const;
    double added_N(const DamperInput &input, double current_A, double base_N,
                   const double *state) const;
    double base_N(const DamperInput &input, double current_A, const double *state,
                  double *rates) const;
    std::vector<double> quick_state(double moved_m, double current_A) const;
    double quick_force_N(double moved_m, double current_A) const;

    HysteresisNetworkParams params_;
    std::vector<Network> members_;
    std::vector<std::vector<quiesce_layer>> layers_; ///< of each member
    std::vector<const quiesce_layer *> first_layers_;
    std::vector<int> layer_counts_;
    std::size_t widest_ = 0; ///< of the members' hidden layers
    quiesce_hysteresis core_ = {};
    std::size_t own_states_ = 0;
};

} // namespace quiesce

#endif
