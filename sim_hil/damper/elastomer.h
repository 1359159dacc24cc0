/// Magnetorheological elastomer between two plates: a spring whose modulus the current raises, with
/// loss-factor damping.
///
///   k(I) = E'(I) area / thickness      E'(I) = E0 + E1 I + E2 I^2
///   F    = k x + (loss_factor k / w) v
///
/// Damping of a loss factor falls with the frequency, which no force of x and v at one instant can:
/// w is fixed, where the motion is expected. Where E2 < 0 the modulus stays at its highest beyond
/// I = -E1 / (2 E2): a saturated material does not soften, the quadratic would.
/// No state. A current that changes while x is not 0 does work: the coil pays for it.
#ifndef QUIESCE_ELASTOMER_H
#define QUIESCE_ELASTOMER_H

#include <algorithm>
#include <array>
#include <limits>

#include "damper.h"

namespace quiesce {

struct ElastomerParams {
    double area_m2;                    ///< > 0
    double thickness_m;                ///< > 0
    std::array<double, 3> storage_MPa; ///< storage modulus: E0 > 0, E1 per A >= 0, E2 per A^2
    double loss_factor;                ///< >= 0
    double loss_freq_Hz;               ///< where it holds, > 0
    double stroke_m;                   ///< the model ends at -stroke_m, > 0
};

class Elastomer final : public Damper {
  public:
    explicit Elastomer(const ElastomerParams &params)
        : params_(params), highest_A_(params.storage_MPa[2] < 0.0
                                          ? -0.5 * params.storage_MPa[1] / params.storage_MPa[2]
                                          : std::numeric_limits<double>::infinity()) {}

    double force_N(const DamperInput &input, const double * /*state*/,
                   double * /*rates*/) const override {
        return stiffest_N_m(input.current_A) * (input.position_m + loss_s() * input.velocity_m_s);
    }
    double stiffest_N_s_m(double current_A) const override {
        return stiffest_N_m(current_A) * loss_s();
    }
    double stiffest_N_m(double current_A) const override {
        constexpr double kPaPerMPa = 1e6;
        const double I = std::min(current_A, highest_A_);
        const auto &E = params_.storage_MPa;
        return kPaPerMPa * (E[0] + I * (E[1] + I * E[2])) * params_.area_m2 / params_.thickness_m;
    }
    double lowest_position_m() const override { return -params_.stroke_m; }

  private:
    /// loss_factor / w
    double loss_s() const {
        constexpr double kTwoPi = 6.28318530717958647692;
        return params_.loss_factor / (kTwoPi * params_.loss_freq_Hz);
    }

    ElastomerParams params_;
    double highest_A_; ///< current of the highest modulus
};

} // namespace quiesce

#endif
