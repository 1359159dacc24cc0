#include "plant_model.h"

#include <algorithm>
#include <cmath>

#include "input_error.h"

namespace quiesce {

namespace {

/// What dampers and mounts add to the fastest rates, at no or all current: whichever is more.
struct Stiffest {
    double slope_1_s = 0.0;
    double omega2_rad2_s2 = 0.0;
    double state_rate_1_s = 0.0;
};

Stiffest stiffest(const PlantModel &model) {
    Stiffest out;
    const double full_A = model.driver.max_current_A;
    for (const PlantDamper &one : model.dampers) {
        const Damper &damper = *one.damper;
        const double shape2 = one.stroke.squaredNorm();
        out.slope_1_s +=
            std::max(damper.stiffest_N_s_m(0.0), damper.stiffest_N_s_m(full_A)) * shape2;
        out.omega2_rad2_s2 +=
            std::max(damper.stiffest_N_m(0.0), damper.stiffest_N_m(full_A)) * shape2;
        out.state_rate_1_s = std::max(
            {out.state_rate_1_s, damper.fastest_rate_1_s(0.0), damper.fastest_rate_1_s(full_A)});
    }
    for (const PlantMount &one : model.mounts) {
        const double shape2 = one.stroke.squaredNorm();
        out.slope_1_s += one.mount->stiffest_N_s_m() * shape2;
        out.omega2_rad2_s2 += one.mount->stiffest_N_m() * shape2;
    }
    return out;
}

} // namespace

std::string label(const PlantDamper &damper) {
    return damper.name == kOnlyDamper ? damper.name : "damper " + damper.name;
}

void require_one_damper(const PlantModel &model) {
    if (model.dampers.size() > 1) {
        throw InputError("plant " + model.name + " has " + std::to_string(model.dampers.size()) +
                         " dampers; this works on plants with one");
    }
}

double longest_safe_step_s(const PlantModel &model) {
    const Structure &structure = model.structure;
    const Stiffest added = stiffest(model);
    const double omega = std::sqrt(structure.omega2_rad2_s2.maxCoeff() + added.omega2_rad2_s2);
    const double rate_1_s = omega + structure.damping_1_s.norm() + added.slope_1_s;
    return std::min(0.9 / rate_1_s, 2.0 / std::max(added.state_rate_1_s, 1e-9));
}

std::int64_t steps_per_tick(const PlantModel &model, double tick_s) {
    // The tolerance keeps a quotient such as 1 ms / 0.25 ms from being rounded up.
    return static_cast<std::int64_t>(std::ceil(tick_s / model.max_step_s * (1.0 - 1e-9)));
}

} // namespace quiesce
