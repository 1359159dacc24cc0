#include "metrics.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

namespace {

constexpr double kSettleWindow_s = 0.2;
constexpr double kSettleTolerance = 0.05;

/// Time and phase that rounding may be off by.
constexpr double kSlack_s = 1e-9;
constexpr double kSlack_cycles = 1e-6;

/// Part of a cycle that must have been seen before the cycle counts.
constexpr double kWholeCycle = 0.99;

Window transient_window(const std::optional<Transient> &transient) {
    return transient ? Window{transient->start_s, transient->disp_end_s} : Window{0.0, 0.0};
}

} // namespace

void WindowMetrics::add(double time_s, const PlantTruth &truth) {
    if (time_s > window_.end_s + kSlack_s) {
        return;
    }
    const Integrand now = {truth.accel_m_s2 * truth.accel_m_s2,
                           truth.displacement_m * truth.displacement_m, truth.coil_A,
                           -truth.damper_force_N * truth.damper_velocity_m_s};
    const double distance_m = std::abs(truth.displacement_m);
    if (time_s <= window_.start_s + kSlack_s) {
        start_cycles_ = truth.phase_cycles;
        peak_m_ = distance_m;
    } else {
        peak_m_ = std::max(peak_m_, distance_m);
        is_periodic_ = is_periodic_ && truth.phase_cycles > phase_cycles_;
        duration_s_ += time_s - time_s_;
        accumulate(now);
        track_cycle(truth);
    }
    time_s_ = time_s;
    phase_cycles_ = truth.phase_cycles;
    last_ = now;
}

void WindowMetrics::accumulate(const Integrand &now) {
    step_count_ += 1.0;
    sum_.accel_square += 0.5 * (last_.accel_square + now.accel_square);
    sum_.displacement_square += 0.5 * (last_.displacement_square + now.displacement_square);
    sum_.current_A += 0.5 * (last_.current_A + now.current_A);
    sum_.damper_power_W += 0.5 * (last_.damper_power_W + now.damper_power_W);
}

void WindowMetrics::track_cycle(const PlantTruth &truth) {
    const double since_start = truth.phase_cycles - start_cycles_;
    // A sample on the border belongs to the cycle that it ends.
    const double number = std::ceil(since_start - kSlack_cycles);
    if (number > cycle_.number) {
        close_cycle();
        cycle_ = {number, 0.0, truth.displacement_m, truth.displacement_m, true};
    }
    cycle_.last_cycles = since_start;
    cycle_.low_m = std::min(cycle_.low_m, truth.displacement_m);
    cycle_.high_m = std::max(cycle_.high_m, truth.displacement_m);
}

void WindowMetrics::close_cycle() {
    if (cycle_.has_sample) {
        half_peaks_sum_m_ += 0.5 * (cycle_.high_m - cycle_.low_m);
        cycle_count_ += 1.0;
    }
}

std::optional<double> WindowMetrics::amplitude_m() const {
    if (!is_periodic_) {
        return std::nullopt;
    }
    WindowMetrics whole = *this;
    const bool is_whole = cycle_.last_cycles - (cycle_.number - 1.0) >= kWholeCycle;
    if (is_whole || cycle_count_ == 0.0) {
        whole.close_cycle();
    }
    return whole.half_peaks_sum_m_ / whole.cycle_count_;
}

double WindowMetrics::accel_rms_m_s2() const {
    return std::sqrt(sum_.accel_square / step_count_);
}

double WindowMetrics::displacement_rms_m() const {
    return std::sqrt(sum_.displacement_square / step_count_);
}

double WindowMetrics::mean_current_A() const {
    return sum_.current_A / step_count_;
}

double WindowMetrics::damper_work_J() const {
    return sum_.damper_power_W / step_count_ * duration_s_;
}

std::optional<double> settling_time_s(const std::vector<double> &squares, double sample_s,
                                      double start_s, double window_s, double final_rms,
                                      double tolerance) {
    const auto length = static_cast<std::size_t>(std::lround(window_s / sample_s));
    const auto first = static_cast<std::size_t>(std::lround(start_s / sample_s));
    double sum = 0.0;
    std::size_t settled_from = first;
    for (std::size_t i = 0; i < squares.size(); ++i) {
        sum += squares[i] - (i >= length ? squares[i - length] : 0.0);
        const double rms = std::sqrt(std::max(sum, 0.0) / static_cast<double>(length));
        if (i >= first && std::abs(rms - final_rms) > tolerance * final_rms) {
            settled_from = i + 1;
        }
    }
    if (settled_from >= squares.size()) {
        return std::nullopt;
    }
    return static_cast<double>(settled_from + 1) * sample_s - start_s;
}

MetricsObserver::MetricsObserver(const RunSetup &setup)
    : transient_(setup.scenario.transient),
      after_transient_(transient_window(setup.scenario.transient)), tick_s_(setup.tick_s()) {
    for (const Window &window : setup.scenario.windows) {
        windows_.emplace_back(window);
    }
}

void MetricsObserver::on_steps(double start_s, double step_s,
                               const std::vector<PlantTruth> &steps) {
    double time_s = start_s;
    double square_sum = 0.0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        time_s = start_s + static_cast<double>(i + 1) * step_s;
        for (WindowMetrics &window : windows_) {
            window.add(time_s, steps[i]);
        }
        if (transient_) {
            after_transient_.add(time_s, steps[i]);
            square_sum += steps[i].accel_m_s2 * steps[i].accel_m_s2;
        }
    }
    if (transient_) {
        accel_squares_.push_back(square_sum / static_cast<double>(steps.size()));
    }
}

RunMetrics MetricsObserver::result() const {
    RunMetrics out{windows_, windows_.back().displacement_rms_m(), std::nullopt, std::nullopt};
    if (transient_) {
        out.transient_peak_m = after_transient_.peak_displacement_m();
        out.rms_displacement_m = after_transient_.displacement_rms_m();
        out.settle_s =
            settling_time_s(accel_squares_, tick_s_, transient_->start_s, kSettleWindow_s,
                            windows_.back().accel_rms_m_s2(), kSettleTolerance);
    }
    return out;
}

} // namespace quiesce
