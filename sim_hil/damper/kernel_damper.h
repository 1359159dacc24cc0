/// A kernel as the damper of a plant: parameters follow the coil current and the
/// temperature of the fluid; the rig is left out.
#ifndef QUIESCE_KERNEL_DAMPER_H
#define QUIESCE_KERNEL_DAMPER_H

#include <algorithm>
#include <array>
#include <cstddef>

#include "damper.h"
#include "field_law.h"
#include "fluid_law.h"
#include "kernel.h"
#include "motion_of.h"

namespace quiesce {

/// Coefficients of one parameter against the current, ascending.
using CurrentLaw = std::array<double, 3>;

template <class Kernel>
class KernelDamper final : public Damper {
  public:
    /// laws: Kernel::kParameters.size() of them. stroke_m: the model ends at -stroke_m; speed_m_s:
    /// the largest that is expected.
    KernelDamper(const CurrentLaw *laws, double stroke_m, double speed_m_s,
                 const FieldLaw<double> &field = {}, const FluidLaw &fluid = {})
        : stroke_m_(stroke_m), speed_m_s_(speed_m_s), field_(field), fluid_(fluid) {
        std::copy(laws, laws + kCount, laws_.begin());
    }

    std::size_t state_count() const override { return Kernel::kStates; }
    bool uses_accel() const override { return Kernel::kUsesAccel; }

    double force_N(const DamperInput &input, const double *state, double *rates) const override {
        const Parameters p = parameters(input.current_A, input.temperature_C);
        return Kernel::force_N(p.data(), motion_of(input), state, rates);
    }
    double stiffest_N_s_m(double current_A) const override {
        return Kernel::stiffest_N_s_m(coldest(current_A).data());
    }
    double stiffest_N_m(double current_A) const override {
        return Kernel::stiffest_N_m(coldest(current_A).data());
    }
    double fastest_rate_1_s(double current_A) const override {
        return Kernel::fastest_rate_1_s(coldest(current_A).data(), speed_m_s_);
    }
    double lowest_position_m() const override { return -stroke_m_; }

  private:
    static constexpr std::size_t kCount = Kernel::kParameters.size();
    using Parameters = std::array<double, kCount>;

    Parameters coldest(double current_A) const { return parameters(current_A, fluid_.coldest_C); }

    Parameters parameters(double coil_current_A, double temperature_C) const {
        const double current_A = field_.effective(coil_current_A);
        Parameters p{};
        for (std::size_t k = 0; k < kCount; ++k) {
            const CurrentLaw &c = laws_[k];
            const ParameterInfo &info = Kernel::kParameters[k];
            p[k] = std::clamp(c[0] + current_A * (c[1] + current_A * c[2]), info.min, info.max);
        }
        if (!fluid_.is_constant()) {
            weaken(fluid_.at(temperature_C), p);
        }
        return p;
    }

    static void weaken(const FluidFactors &factors, Parameters &p) {
        for (std::size_t k = 0; k < kCount; ++k) {
            const ParameterInfo &info = Kernel::kParameters[k];
            p[k] *= is_viscous(info) ? factors.viscous : is_yielding(info) ? factors.yielding : 1.0;
        }
    }

    std::array<CurrentLaw, kCount> laws_;
    double stroke_m_;
    double speed_m_s_;
    FieldLaw<double> field_;
    FluidLaw fluid_;
};

} // namespace quiesce

#endif
