/// What each body and damper of a board did in each window, from true values at the ticks.
#ifndef QUIESCE_RIG_METRICS_H
#define QUIESCE_RIG_METRICS_H

#include <vector>

#include "run.h"

namespace quiesce {

struct BodyMetrics {
    double ticks = 0.0;
    double displacement_squares = 0.0;
    double accel_squares = 0.0;
    double peak_m = 0.0; ///< largest distance from rest, relative to the base

    void add(const PlaceTruth &truth);
    double displacement_rms_m() const;
    double accel_rms_m_s2() const;
};

struct DamperMetrics {
    double ticks = 0.0;
    double current_sum_A = 0.0;
    double peak_force_N = 0.0;
    double peak_stroke_m = 0.0;

    void add(const DamperTruth &truth);
    double mean_current_A() const;
};

struct RigWindow {
    Window window;
    std::vector<BodyMetrics> bodies;
    std::vector<DamperMetrics> dampers;
};

class RigMetrics final : public TickObserver {
  public:
    /// setup must outlive it; nothing without a rig.
    explicit RigMetrics(const RunSetup &setup);

    void on_tick(const TickRecord &record) override;

    const std::vector<RigWindow> &windows() const { return windows_; }

  private:
    const RunSetup &setup_;
    std::vector<RigWindow> windows_;
};

} // namespace quiesce

#endif
