/// What a run is judged by, from true values at every integration step.
///
///   amplitude   mean over the excitation's whole cycles of half the peak-to-peak displacement;
///               nothing where the excitation has no one frequency in some of the window
///   peak        largest distance from rest
///   accel RMS   root mean square of the acceleration
///   current     mean coil current
///   work        done by the damper on the structure, < 0 where it dissipates
///   settling    from the transient's start until the 0.2 s trailing RMS of the acceleration stays
///               within 5 % of its RMS over the last window
#ifndef QUIESCE_METRICS_H
#define QUIESCE_METRICS_H

#include <optional>
#include <vector>

#include "run.h"

namespace quiesce {

/// Steady state over one window: means by the trapezoidal rule over the integration steps in it.
class WindowMetrics {
  public:
    explicit WindowMetrics(const Window &window) : window_(window) {}

    void add(double time_s, const PlantTruth &truth);

    std::optional<double> amplitude_m() const;
    double accel_rms_m_s2() const;
    double displacement_rms_m() const;
    double peak_displacement_m() const { return peak_m_; }
    double mean_current_A() const;
    double damper_work_J() const;

  private:
    struct Cycle {
        double number = 0.0;
        double last_cycles = 0.0; ///< phase of its last sample, since the window began
        double low_m = 0.0;
        double high_m = 0.0;
        bool has_sample = false;
    };

    /// What is averaged, at one instant.
    struct Integrand {
        double accel_square;
        double displacement_square;
        double current_A;
        double damper_power_W;
    };

    void accumulate(const Integrand &now);
    void track_cycle(const PlantTruth &truth);
    void close_cycle();

    Window window_;
    double time_s_ = 0.0; ///< of the last sample
    double phase_cycles_ = 0.0;
    bool is_periodic_ = true; ///< the phase has gone on in every step
    double peak_m_ = 0.0;
    double start_cycles_ = 0.0;
    Cycle cycle_;
    double half_peaks_sum_m_ = 0.0;
    double cycle_count_ = 0.0;
    double step_count_ = 0.0;
    double duration_s_ = 0.0;
    Integrand last_{};
    Integrand sum_{};
};

/// Time from start_s until the trailing RMS over window_s of a signal stays within tolerance
/// (relative) of final_rms. squares: the signal's squares, one each sample_s, squares[i] at
/// (i + 1) * sample_s; start_s >= 0. Nothing when it never stays there.
std::optional<double> settling_time_s(const std::vector<double> &squares, double sample_s,
                                      double start_s, double window_s, double final_rms,
                                      double tolerance);

struct RunMetrics {
    std::vector<WindowMetrics> windows;
    double rms_displacement_m; ///< of the last window, or of the transient where there is one
    std::optional<double> transient_peak_m;
    std::optional<double> settle_s; ///< only with a transient that settles
};

class MetricsObserver final : public TickObserver {
  public:
    explicit MetricsObserver(const RunSetup &setup);

    void on_tick(const TickRecord & /*record*/) override {}
    void on_steps(double start_s, double step_s, const std::vector<PlantTruth> &steps) override;

    RunMetrics result() const;

  private:
    std::vector<WindowMetrics> windows_;
    std::optional<Transient> transient_;
    WindowMetrics after_transient_;
    std::vector<double> accel_squares_; ///< mean over each tick, only with a transient
    double tick_s_;
};

} // namespace quiesce

#endif
