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

#include <array>

#include "elementary.h"
#include "motion_of.h"

namespace quiesce {

struct ElastomerParams {
    double area_m2;                    ///< > 0
    double thickness_m;                ///< > 0
    std::array<double, 3> storage_MPa; ///< storage modulus: E0 > 0, E1 per A >= 0, E2 per A^2
    double loss_factor;                ///< >= 0
    double loss_freq_Hz;               ///< where it holds, > 0
    double stroke_m;                   ///< the model ends at -stroke_m, > 0
};

template <class T>
struct ElastomerLaw {
    T area_m2;
    T thickness_m;
    std::array<T, 3> storage_MPa;
    T loss_factor;
    T loss_freq_Hz;

    T force_N(const Motion<T> &m) const { return stiffness_N_m(m.i) * (m.x + loss_s() * m.v); }
    T stiffness_N_m(const T &current_A) const {
        const std::array<T, 3> &E = storage_MPa;
        // Where the modulus falls at last, no further than to its highest.
        const T falling = smaller(E[2], T(-1e-300));
        const T highest_A = T(-0.5) * E[1] / falling;
        const T I = select(E[2] < T(0.0), smaller(current_A, highest_A), current_A);
        return T(1e6) * (E[0] + I * (E[1] + I * E[2])) * area_m2 / thickness_m;
    }
    /// loss_factor / w
    T loss_s() const { return loss_factor / (T(6.28318530717958647692) * loss_freq_Hz); }
};

class Elastomer final : public Damper {
  public:
    explicit Elastomer(const ElastomerParams &params)
        : law_{params.area_m2, params.thickness_m, params.storage_MPa, params.loss_factor,
               params.loss_freq_Hz},
          stroke_m_(params.stroke_m) {}

    double force_N(const DamperInput &input, const double * /*state*/,
                   double * /*rates*/) const override {
        return law_.force_N(motion_of(input));
    }
    double stiffest_N_s_m(double current_A) const override {
        return law_.stiffness_N_m(current_A) * law_.loss_s();
    }
    double stiffest_N_m(double current_A) const override { return law_.stiffness_N_m(current_A); }
    double lowest_position_m() const override { return -stroke_m_; }

  private:
    ElastomerLaw<double> law_;
    double stroke_m_;
};

} // namespace quiesce

#endif
