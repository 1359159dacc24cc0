/// Squeeze-mode MR damper: a biviscous film between two discs, one of which moves along the axis.
///
///   gap        h    = gap_m + position              (opening is positive)
///   field      H    = coil_turns I / (2 pi coil_radius_m)
///   yield      tau1 = yield_coefficient H^yield_exponent
///   force      F    = force_scale (2 pi tau1 a^3 / h) Psi(eta a |v| / (h^2 tau1)) sgn(v)
///   no field   F    = force_scale 3 pi eta a^4 v / (2 h^3)        (Stefan, for tau1 < 1e-3 Pa)
///
/// A warm fluid (fluid_law.h) lowers eta and tau1. Quasi-static: no state. No remanence, cavitation
/// or magnetic saturation. Psi: squeeze_psi.h.
#ifndef QUIESCE_SQUEEZE_BIVISCOSITY_H
#define QUIESCE_SQUEEZE_BIVISCOSITY_H

#include "damper.h"
#include "fluid_law.h"
#include "squeeze_film_law.h"
#include "squeeze_psi.h"

namespace quiesce {

struct SqueezeBiviscosityParams {
    double plate_radius_m;    ///< a > 0
    double gap_m;             ///< h at rest, > 0
    double min_gap_m;         ///< the model ends here (a smaller gap counts as this), > 0
    double viscosity_Pa_s;    ///< eta, post-yield, > 0
    double viscosity_ratio;   ///< gamma = post-yield / pre-yield viscosity, in (0, 1]
    double yield_coefficient; ///< A_h in Pa/(A/m)^yield_exponent, >= 0
    double yield_exponent;    ///< b > 0
    double coil_turns;        ///< > 0
    double coil_radius_m;     ///< mean radius of the flux path, > 0
    double force_scale;       ///< part of the film force that reaches the structure, >= 0
    FluidLaw fluid = {};
};

class SqueezeBiviscosity final : public Damper {
  public:
    explicit SqueezeBiviscosity(const SqueezeBiviscosityParams &params);

    double force_N(const DamperInput &input, const double *state, double *rates) const override;
    double stiffest_N_s_m(double current_A) const override;
    double lowest_position_m() const override { return params_.min_gap_m - params_.gap_m; }

    /// tau1 at this current and reference temperature.
    double yield_stress_Pa(double current_A) const;

  private:
    SqueezeBiviscosityParams params_;
    SqueezePsi psi_;
    double field_per_A_; ///< H / I
    SqueezeFilmLaw<double> law_;
};

} // namespace quiesce

#endif
