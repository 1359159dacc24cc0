#include "damper_over_motion.h"

#include <vector>

#include "rk4.h"

namespace quiesce {

namespace {

DamperInput input_at(const MotionGrid &motion, std::size_t half_step) {
    const double *at = motion.at(half_step);
    DamperInput input{};
    input.position_m = at[0];
    input.velocity_m_s = at[1];
    input.accel_m_s2 = at[2];
    input.current_A = at[3];
    return input;
}

} // namespace

void damper_over_motion(const Damper &damper, const MotionGrid &motion, double *force_N) {
    std::vector<double> state(damper.state_count(), 0.0);
    std::vector<double> rates(state.size(), 0.0);
    Rk4 rk4(state.size());
    const auto substeps = static_cast<std::size_t>(motion.substeps());
    for (std::size_t step = 0; step <= motion.steps(); ++step) {
        const double force = damper.force_N(input_at(motion, 2 * step), state.data(), rates.data());
        if (step % substeps == 0) {
            force_N[step / substeps] = force;
        }
        if (step == motion.steps() || state.empty()) {
            continue;
        }
        rk4.step(state, rates, motion.step_s(),
                 [&](int at, const std::vector<double> &y, std::vector<double> &out) {
                     const auto half = 2 * step + static_cast<std::size_t>(at);
                     damper.force_N(input_at(motion, half), y.data(), out.data());
                 });
        damper.after_step(input_at(motion, 2 * (step + 1)), state.data(), motion.step_s());
    }
}

} // namespace quiesce
