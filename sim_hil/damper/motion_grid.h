/// A recorded motion, ready to be integrated over: values at every half step.
#ifndef QUIESCE_MOTION_GRID_H
#define QUIESCE_MOTION_GRID_H

#include <cstddef>
#include <vector>

namespace quiesce {

/// Samples of a motion at a uniform rate, count of each, count >= 2.
struct MotionSamples {
    std::size_t count;
    double step_s;
    const double *disp_m;
    const double *velocity_m_s;
    const double *accel_m_s2;
    const double *command_A;
};

/// Between samples displacement and velocity are cubic (Hermite, with the velocity and the
/// acceleration as slopes), acceleration and command linear.
class MotionGrid {
  public:
    /// substeps integration steps in a sampling interval, >= 1.
    MotionGrid(const MotionSamples &samples, int substeps);

    std::size_t steps() const { return steps_; }
    int substeps() const { return substeps_; }
    double step_s() const { return step_s_; }
    std::size_t samples() const { return steps_ / static_cast<std::size_t>(substeps_) + 1; }

    /// Four values (x, v, a, command) at half step `index`, 0 .. 2 steps.
    const double *at(std::size_t index) const { return values_.data() + 4 * index; }

  private:
    std::size_t steps_;
    int substeps_;
    double step_s_;
    std::vector<double> values_;
};

} // namespace quiesce

#endif
