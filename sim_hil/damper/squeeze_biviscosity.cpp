#include "squeeze_biviscosity.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

namespace {

constexpr double kPi = 3.14159265358979323846;

} // namespace

SqueezeBiviscosity::SqueezeBiviscosity(const SqueezeBiviscosityParams &params)
    : params_(params), psi_(params.viscosity_ratio),
      field_per_A_(params.coil_turns / (2.0 * kPi * params.coil_radius_m)),
      law_{params.viscosity_Pa_s * params.plate_radius_m,
           params.force_scale * 2.0 * kPi * std::pow(params.plate_radius_m, 3.0),
           params.force_scale * 1.5 * kPi * params.viscosity_Pa_s *
               std::pow(params.plate_radius_m, 4.0)} {}

double SqueezeBiviscosity::yield_stress_Pa(double current_A) const {
    const double field_A_m = field_per_A_ * current_A;
    return params_.yield_exponent == 1.0
               ? params_.yield_coefficient * field_A_m
               : params_.yield_coefficient * std::pow(field_A_m, params_.yield_exponent);
}

double SqueezeBiviscosity::force_N(const DamperInput &input, const double * /*state*/,
                                   double * /*rates*/) const {
    const double gap_m = std::max(params_.gap_m + input.position_m, params_.min_gap_m);
    const FluidFactors warm = params_.fluid.at(input.temperature_C);
    const double yield_Pa = warm.yielding * yield_stress_Pa(input.current_A);
    if (yield_Pa < kFilmNoYield_Pa) {
        return warm.viscous * law_.newtonian_N(input.velocity_m_s, gap_m);
    }
    const double per_film = 1.0 / (gap_m * gap_m * yield_Pa);
    const double chi = warm.viscous * law_.chi(std::abs(input.velocity_m_s), per_film);
    const double force = law_.yielded_N(yield_Pa, gap_m, per_film, psi_(chi));
    return std::copysign(force, input.velocity_m_s);
}

double SqueezeBiviscosity::stiffest_N_s_m(double current_A) const {
    const double viscous = params_.fluid.at(params_.fluid.coldest_C).viscous;
    const double newtonian = viscous * law_.stefan / std::pow(params_.gap_m, 3.0);
    // The unyielded film is stiffest, and its viscosity does not depend on the current.
    return yield_stress_Pa(current_A) < kFilmNoYield_Pa ? newtonian
                                                        : newtonian / params_.viscosity_ratio;
}

} // namespace quiesce
