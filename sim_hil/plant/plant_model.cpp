#include "plant_model.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

double longest_safe_step_s(const PlantModel &model) {
    const Structure &structure = model.structure;
    const double slope_N_s_m = std::max(model.damper->stiffest_N_s_m(0.0),
                                        model.damper->stiffest_N_s_m(model.driver.max_current_A));
    const double stiffness_N_m = std::max(model.damper->stiffest_N_m(0.0),
                                          model.damper->stiffest_N_m(model.driver.max_current_A));
    const double omega = std::sqrt(structure.omega2_rad2_s2.maxCoeff() +
                                   stiffness_N_m * structure.at_damper.squaredNorm());
    const double rate_1_s =
        omega + structure.damping_1_s.norm() + slope_N_s_m * structure.at_damper.squaredNorm();
    const double state_rate_1_s =
        std::max(model.damper->fastest_rate_1_s(0.0),
                 model.damper->fastest_rate_1_s(model.driver.max_current_A));
    return std::min(0.9 / rate_1_s, 2.0 / std::max(state_rate_1_s, 1e-9));
}

std::int64_t steps_per_tick(const PlantModel &model, double tick_s) {
    // The tolerance keeps a quotient such as 1 ms / 0.25 ms from being rounded up.
    return static_cast<std::int64_t>(std::ceil(tick_s / model.max_step_s * (1.0 - 1e-9)));
}

} // namespace quiesce
