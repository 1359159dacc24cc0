/// Linear damper whose coefficient rises with the current: F = (base + per_A I) v. No state.
/// For first trials of a plant, and as the damper whose closed loop is known in closed form.
#ifndef QUIESCE_VISCOUS_H
#define QUIESCE_VISCOUS_H

#include "motion_of.h"

namespace quiesce {

struct ViscousParams {
    double base_N_s_m;  ///< >= 0
    double per_A_N_s_m; ///< N s/m per ampere, >= 0
    double stroke_m;    ///< the model ends at -stroke_m, > 0
};

template <class T>
struct ViscousLaw {
    T base_N_s_m;
    T per_A_N_s_m;

    T damping_N_s_m(const T &current_A) const { return base_N_s_m + per_A_N_s_m * current_A; }
    T force_N(const Motion<T> &m) const { return damping_N_s_m(m.i) * m.v; }
};

class Viscous final : public Damper {
  public:
    explicit Viscous(const ViscousParams &params)
        : law_{params.base_N_s_m, params.per_A_N_s_m}, stroke_m_(params.stroke_m) {}

    double force_N(const DamperInput &input, const double * /*state*/,
                   double * /*rates*/) const override {
        return law_.force_N(motion_of(input));
    }
    double stiffest_N_s_m(double current_A) const override { return law_.damping_N_s_m(current_A); }
    double lowest_position_m() const override { return -stroke_m_; }

  private:
    ViscousLaw<double> law_;
    double stroke_m_;
};

} // namespace quiesce

#endif
