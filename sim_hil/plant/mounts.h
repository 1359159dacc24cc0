/// The kinds of mounts.
#ifndef QUIESCE_MOUNTS_H
#define QUIESCE_MOUNTS_H

#include <algorithm>
#include <cmath>

#include "mount.h"

namespace quiesce {

/// Stops on both sides, `gap_m` away at rest: a spring and a drag where they touch. They push and
/// never pull, so that a drag that would hold back what leaves is cut off.
class GappedMount final : public Mount {
  public:
    /// gap_m >= 0, the others >= 0.
    GappedMount(double gap_m, double stiffness_N_m, double damping_N_s_m)
        : gap_m_(gap_m), stiffness_N_m_(stiffness_N_m), damping_N_s_m_(damping_N_s_m) {}

    double force_N(double stroke_m, double velocity_m_s) const override {
        const double pressed_m = std::abs(stroke_m) - gap_m_;
        if (pressed_m <= 0.0) {
            return 0.0;
        }
        // Towards the side that it touches.
        const double speed_m_s = std::copysign(1.0, stroke_m) * velocity_m_s;
        const double push_N = stiffness_N_m_ * pressed_m + damping_N_s_m_ * speed_m_s;
        return std::copysign(std::max(push_N, 0.0), stroke_m);
    }
    double stiffest_N_m() const override { return stiffness_N_m_; }
    double stiffest_N_s_m() const override { return damping_N_s_m_; }

  private:
    double gap_m_;
    double stiffness_N_m_;
    double damping_N_s_m_;
};

/// What is pressed on by a weight, such as a tyre on a road: at rest it carries preload_N, and it
/// lifts off where it would have to pull. Resisting forces are those beside the preload, so that
/// they end there.
class ContactMount final : public Mount {
  public:
    /// preload_N > 0, the others >= 0.
    ContactMount(double stiffness_N_m, double damping_N_s_m, double preload_N)
        : stiffness_N_m_(stiffness_N_m), damping_N_s_m_(damping_N_s_m), preload_N_(preload_N) {}

    double force_N(double stroke_m, double velocity_m_s) const override {
        return std::min(stiffness_N_m_ * stroke_m + damping_N_s_m_ * velocity_m_s, preload_N_);
    }
    double stiffest_N_m() const override { return stiffness_N_m_; }
    double stiffest_N_s_m() const override { return damping_N_s_m_; }

  private:
    double stiffness_N_m_;
    double damping_N_s_m_;
    double preload_N_;
};

/// A spring that gives way: F = limit tanh(stiffness x / limit).
class SofteningMount final : public Mount {
  public:
    /// stiffness_N_m >= 0: about rest. limit_N > 0: that it tends to.
    SofteningMount(double stiffness_N_m, double limit_N)
        : stiffness_N_m_(stiffness_N_m), limit_N_(limit_N) {}

    double force_N(double stroke_m, double /*velocity_m_s*/) const override {
        return limit_N_ * std::tanh(stiffness_N_m_ * stroke_m / limit_N_);
    }
    double stiffest_N_m() const override { return stiffness_N_m_; }
    double stiffest_N_s_m() const override { return 0.0; }

  private:
    double stiffness_N_m_;
    double limit_N_;
};

} // namespace quiesce

#endif
