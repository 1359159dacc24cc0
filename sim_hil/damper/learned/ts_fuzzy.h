/// Takagi-Sugeno fuzzy model with clusters as rules and a linear force in each.
///
///   F = sum_r w_r (a1_r x + a2_r v + b_r i + f0_r) / sum_r w_r
///   w_r = product over the inputs of exp(-(u - m_r)^2 / (2 s_r^2))
///
/// The inputs of the box, in their order, take the place of x, v and i. Source: Du 2009.
#ifndef QUIESCE_TS_FUZZY_H
#define QUIESCE_TS_FUZZY_H

#include <vector>

#include "input_box.h"

namespace quiesce {

/// One number for each input in the first three.
struct FuzzyCluster {
    std::vector<double> centre; ///< scaled to -1 .. 1
    std::vector<double> width;  ///< > 0, scaled likewise
    std::vector<double> gain_N; ///< force for one unit of the scaled input
    double offset_N;
};

class TsFuzzy final : public StaticDamper {
  public:
    /// At least one cluster.
    TsFuzzy(InputBox box, double stroke_m, const std::vector<FuzzyCluster> &clusters);

    double force_N(const DamperInput &input, const double *state, double *rates) const override;

  private:
    std::vector<double> centres_;
    std::vector<double> widths_;
    std::vector<double> gains_N_;
    std::vector<double> offsets_N_;
};

} // namespace quiesce

#endif
