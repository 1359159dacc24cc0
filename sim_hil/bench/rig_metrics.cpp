#include "rig_metrics.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

namespace {

double mean(double sum, double ticks) {
    return ticks > 0.0 ? sum / ticks : 0.0;
}

} // namespace

void BodyMetrics::add(const PlaceTruth &truth) {
    ticks += 1.0;
    displacement_squares += truth.displacement_m * truth.displacement_m;
    accel_squares += truth.accel_m_s2 * truth.accel_m_s2;
    peak_m = std::max(peak_m, std::abs(truth.displacement_m));
}

double BodyMetrics::displacement_rms_m() const {
    return std::sqrt(mean(displacement_squares, ticks));
}

double BodyMetrics::accel_rms_m_s2() const {
    return std::sqrt(mean(accel_squares, ticks));
}

void DamperMetrics::add(const DamperTruth &truth) {
    ticks += 1.0;
    current_sum_A += truth.coil_A;
    peak_force_N = std::max(peak_force_N, std::abs(truth.force_N));
    peak_stroke_m = std::max(peak_stroke_m, std::abs(truth.stroke_m));
}

double DamperMetrics::mean_current_A() const {
    return mean(current_sum_A, ticks);
}

RigMetrics::RigMetrics(const RunSetup &setup) : setup_(setup) {
    for (const Window &window : setup.scenario.windows) {
        windows_.push_back(
            {window, std::vector<BodyMetrics>(setup.rig ? setup.rig->place_of.size() : 0),
             std::vector<DamperMetrics>(setup.rig ? setup.rig->damper_of.size() : 0)});
    }
}

void RigMetrics::on_tick(const TickRecord &record) {
    for (RigWindow &window : windows_) {
        if (record.time_s < window.window.start_s || record.time_s >= window.window.end_s) {
            continue;
        }
        for (std::size_t i = 0; i < window.bodies.size(); ++i) {
            window.bodies[i].add(record.plant.place(setup_.rig->place_of[i]));
        }
        for (std::size_t i = 0; i < window.dampers.size(); ++i) {
            window.dampers[i].add(record.plant.damper(setup_.rig->damper_of[i]));
        }
    }
}

} // namespace quiesce
