/// How a warm fluid weakens a damper: factors of its viscous and of its yield force.
///
///   viscous(T)  = exp(activation (1/T - 1/T_reference)), T in K      (Arrhenius)
///   yielding(T) = max(1 - yield (T - T_reference), 0)
///
/// Source: a common reading of Shi's model of an MR damper with temperature, which prints neither
/// equation nor numbers. The same as ThermalFactors of quiesce.damper.learned.temperature.
#ifndef QUIESCE_FLUID_LAW_H
#define QUIESCE_FLUID_LAW_H

#include <algorithm>
#include <cmath>
#include <cstring>

#include "kernel.h"

namespace quiesce {

struct FluidFactors {
    double viscous = 1.0;
    double yielding = 1.0;
};

struct FluidLaw {
    double activation_K = 0.0; ///< >= 0; 0: the viscosity does not change
    double yield_1_K = 0.0;    ///< >= 0; 0: the yield force does not
    double reference_C = 25.0; ///< where both factors are 1
    double coldest_C = 25.0;   ///< of the fluid: there it is stiffest

    bool is_constant() const { return activation_K == 0.0 && yield_1_K == 0.0; }

    FluidFactors at(double temperature_C) const {
        if (is_constant()) {
            return {};
        }
        constexpr double kZero_K = 273.15;
        const double reference_1_K = 1.0 / (reference_C + kZero_K);
        const double rise_K = temperature_C - reference_C;
        return {std::exp(activation_K * (1.0 / (temperature_C + kZero_K) - reference_1_K)),
                std::max(1.0 - yield_1_K * rise_K, 0.0)};
    }
};

/// Which factor a kernel's parameter takes: what is in N s/m the viscous one, what is in N the
/// yield force's, but for the offset f0_N, which is of the gas; all others none.
inline bool is_viscous(const ParameterInfo &info) {
    return info.scale.force == 1 && info.scale.disp == 0 && info.scale.speed == -1;
}
inline bool is_yielding(const ParameterInfo &info) {
    return info.scale.force == 1 && info.scale.disp == 0 && info.scale.speed == 0 &&
           std::strcmp(info.name, "f0_N") != 0;
}

} // namespace quiesce

#endif
