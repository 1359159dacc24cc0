/// ANFIS: a zero-order Takagi-Sugeno system on a grid of Gaussian memberships.
///
///   F = sum_r w_r z_r / sum_r w_r,   w_r = product over the inputs of exp(-(u - m)^2 / (2 s^2))
///
/// One rule for every combination of memberships, the last input's varying fastest.
/// Source: thesis on the RD-8040-1 damper; its text says that AND is the minimum, its tables hold
/// with the product.
#ifndef QUIESCE_ANFIS_H
#define QUIESCE_ANFIS_H

#include <vector>

#include "input_box.h"

namespace quiesce {

/// Memberships of one input: as many widths (> 0) as centres.
struct GaussianSet {
    std::vector<double> centres;
    std::vector<double> widths;
};

class Anfis final : public StaticDamper {
  public:
    /// sets: one for each input of the box, in SI units; consequents_N: one a rule.
    Anfis(InputBox box, double stroke_m, const std::vector<GaussianSet> &sets,
          std::vector<double> consequents_N);

    double force_N(const DamperInput &input, const double *state, double *rates) const override;

  private:
    std::vector<int> counts_;
    std::vector<double> centres_;
    std::vector<double> widths_;
    std::vector<double> consequents_N_;
};

} // namespace quiesce

#endif
