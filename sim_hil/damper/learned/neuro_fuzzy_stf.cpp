#include "neuro_fuzzy_stf.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

namespace {

/// Where no membership holds, the output fades to 0 instead of dividing by it.
constexpr double kLeastWeight = 1e-6;

using Grades = std::array<double, kStfLabels>;

Grades grades(const TriangleSet &set, double value) {
    Grades out{};
    for (std::size_t k = 0; k < kStfLabels; ++k) {
        out[k] = std::max(0.0, 1.0 - 2.0 * std::abs(value - set.centres[k]) / set.bases[k]);
    }
    return out;
}

double gain(const StfParams &p, double current_A) {
    const Grades held = grades(p.current, std::clamp(current_A / p.current_scale_A, 0.0, 1.0));
    double sum = 0.0;
    double moment = 0.0;
    for (std::size_t k = 0; k < kStfLabels; ++k) {
        sum += held[k];
        moment += held[k] * p.gains[k];
    }
    return moment / std::max(sum, kLeastWeight);
}

InputBox box_of(const StfParams &p) {
    return InputBox({{InputKind::current, 0.0, p.current_scale_A},
                     {InputKind::displacement, -p.disp_scale_m, p.disp_scale_m},
                     {InputKind::velocity, -p.velocity_scale_m_s, p.velocity_scale_m_s}});
}

} // namespace

NeuroFuzzyStf::NeuroFuzzyStf(const StfParams &params)
    : StaticDamper(box_of(params), params.stroke_m), params_(params) {}

double NeuroFuzzyStf::force_N(const DamperInput &input, const double * /*state*/,
                              double * /*rates*/) const {
    const StfParams &p = params_;
    const Grades disp = grades(p.disp, std::clamp(input.position_m / p.disp_scale_m, -1.0, 1.0));
    const Grades velocity =
        grades(p.velocity, std::clamp(input.velocity_m_s / p.velocity_scale_m_s, -1.0, 1.0));
    double sum = 0.0;
    double moment = 0.0;
    for (std::size_t r = 0; r < kStfRules; ++r) {
        const double a = disp[r / kStfLabels];
        const double b = velocity[r % kStfLabels];
        const double height = p.uses_minimum ? std::min(a, b) : a * b;
        sum += height;
        moment += height * p.outputs[p.labels[r]];
    }
    return p.force_scale_N * gain(p, input.current_A) * moment / std::max(sum, kLeastWeight);
}

} // namespace quiesce
