/// Linear damper whose current switches a stiffness, too, as in magnetorheological elastomers and
/// mounts: F = (base + per_A I) v + (base + per_A I) x. No state. At a constant current the
/// stiffness does no net work in a cycle; a current that changes with x can make it do so.
#ifndef QUIESCE_SWITCHED_STIFFNESS_H
#define QUIESCE_SWITCHED_STIFFNESS_H

#include "damper.h"

namespace quiesce {

struct SwitchedStiffnessParams {
    double base_N_s_m;  ///< >= 0
    double per_A_N_s_m; ///< N s/m per ampere, >= 0
    double base_N_m;    ///< >= 0
    double per_A_N_m;   ///< N/m per ampere, >= 0
    double stroke_m;    ///< the model ends at -stroke_m, > 0
};

class SwitchedStiffness final : public Damper {
  public:
    explicit SwitchedStiffness(const SwitchedStiffnessParams &params) : params_(params) {}

    double force_N(const DamperInput &input, const double * /*state*/,
                   double * /*rates*/) const override {
        return stiffest_N_s_m(input.current_A) * input.velocity_m_s +
               stiffest_N_m(input.current_A) * input.position_m;
    }
    double stiffest_N_s_m(double current_A) const override {
        return params_.base_N_s_m + params_.per_A_N_s_m * current_A;
    }
    double stiffest_N_m(double current_A) const override {
        return params_.base_N_m + params_.per_A_N_m * current_A;
    }
    double lowest_position_m() const override { return -params_.stroke_m; }

  private:
    SwitchedStiffnessParams params_;
};

} // namespace quiesce

#endif
