/// Linear damper whose coefficient rises with the current: F = (base + per_A I) v. No state.
/// For first trials of a plant, and as the damper whose closed loop is known in closed form.
#ifndef QUIESCE_VISCOUS_H
#define QUIESCE_VISCOUS_H

#include "damper.h"

namespace quiesce {

struct ViscousParams {
    double base_N_s_m;  ///< >= 0
    double per_A_N_s_m; ///< N s/m per ampere, >= 0
    double stroke_m;    ///< the model ends at -stroke_m, > 0
};

class Viscous final : public Damper {
  public:
    explicit Viscous(const ViscousParams &params) : params_(params) {}

    double force_N(const DamperInput &input, const double * /*state*/,
                   double * /*rates*/) const override {
        return stiffest_N_s_m(input.current_A) * input.velocity_m_s;
    }
    double stiffest_N_s_m(double current_A) const override {
        return params_.base_N_s_m + params_.per_A_N_s_m * current_A;
    }
    double lowest_position_m() const override { return -params_.stroke_m; }

  private:
    ViscousParams params_;
};

} // namespace quiesce

#endif
