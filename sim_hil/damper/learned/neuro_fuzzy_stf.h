/// Self-tuning fuzzy model, frozen: 25 rules over displacement and velocity, times a gain that
/// follows the current.
///
///   F = force_scale k(i) u(x, v),   u = sum_r mu_r w_label(r) / max(sum_r mu_r, kLeastWeight)
///   membership: mu = max(0, 1 - 2 |in - a| / b), b the whole width of the base
///
/// Trained on line it needs the measured force; frozen it is a forward model. Source: the STF model
/// of the RD-1005-3 damper; the printed membership (1 - 2 |x - a|) / b is a slip.
#ifndef QUIESCE_NEURO_FUZZY_STF_H
#define QUIESCE_NEURO_FUZZY_STF_H

#include <array>
#include <cstddef>

#include "input_box.h"

namespace quiesce {

constexpr std::size_t kStfLabels = 5;
constexpr std::size_t kStfRules = kStfLabels * kStfLabels;

struct TriangleSet {
    std::array<double, kStfLabels> centres; ///< rising
    std::array<double, kStfLabels> bases;   ///< > 0
};

struct StfParams {
    double force_scale_N;      ///< > 0
    double stroke_m;           ///< > 0
    double disp_scale_m;       ///< > 0; the displacement counts as a part of it, cut off at +-1
    double velocity_scale_m_s; ///< likewise
    double current_scale_A;    ///< likewise, cut off at 0 and 1
    bool uses_minimum;         ///< of the memberships, else their product
    TriangleSet disp;
    TriangleSet velocity;
    TriangleSet current;
    std::array<double, kStfLabels> outputs; ///< w, of NB, NS, ZE, PS, PB
    std::array<double, kStfLabels> gains;   ///< of the current's labels
    /// Label of each rule's output; rows displacement, columns velocity, NB to PB.
    std::array<std::size_t, kStfRules> labels;
};

class NeuroFuzzyStf final : public StaticDamper {
  public:
    explicit NeuroFuzzyStf(const StfParams &params);

    double force_N(const DamperInput &input, const double *state, double *rates) const override;

  private:
    StfParams params_;
};

} // namespace quiesce

#endif
