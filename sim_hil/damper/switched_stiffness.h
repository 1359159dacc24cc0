/// Linear damper whose current switches a stiffness, too, as in magnetorheological elastomers and
/// mounts: F = (base + per_A I) v + (base + per_A I) x. No state. At a constant current the
/// stiffness does no net work in a cycle; a current that changes with x can make it do so.
#ifndef QUIESCE_SWITCHED_STIFFNESS_H
#define QUIESCE_SWITCHED_STIFFNESS_H

#include "motion_of.h"

namespace quiesce {

struct SwitchedStiffnessParams {
    double base_N_s_m;  ///< >= 0
    double per_A_N_s_m; ///< N s/m per ampere, >= 0
    double base_N_m;    ///< >= 0
    double per_A_N_m;   ///< N/m per ampere, >= 0
    double stroke_m;    ///< the model ends at -stroke_m, > 0
};

template <class T>
struct SwitchedStiffnessLaw {
    T base_N_s_m;
    T per_A_N_s_m;
    T base_N_m;
    T per_A_N_m;

    T damping_N_s_m(const T &current_A) const { return base_N_s_m + per_A_N_s_m * current_A; }
    T stiffness_N_m(const T &current_A) const { return base_N_m + per_A_N_m * current_A; }
    T force_N(const Motion<T> &m) const {
        return damping_N_s_m(m.i) * m.v + stiffness_N_m(m.i) * m.x;
    }
};

class SwitchedStiffness final : public Damper {
  public:
    explicit SwitchedStiffness(const SwitchedStiffnessParams &params)
        : law_{params.base_N_s_m, params.per_A_N_s_m, params.base_N_m, params.per_A_N_m},
          stroke_m_(params.stroke_m) {}

    double force_N(const DamperInput &input, const double * /*state*/,
                   double * /*rates*/) const override {
        return law_.force_N(motion_of(input));
    }
    double stiffest_N_s_m(double current_A) const override { return law_.damping_N_s_m(current_A); }
    double stiffest_N_m(double current_A) const override { return law_.stiffness_N_m(current_A); }
    double lowest_position_m() const override { return -stroke_m_; }

  private:
    SwitchedStiffnessLaw<double> law_;
    double stroke_m_;
};

} // namespace quiesce

#endif
