#include "input_box.h"

#include <algorithm>
#include <cmath>

#include "input_box_core.h"

namespace quiesce {

namespace {

/// Points of a range at which slopes are taken.
constexpr int kPoints = 40;

double value_of(const DamperInput &input, InputKind kind) {
    switch (kind) {
    case InputKind::current:
        return input.current_A;
    case InputKind::displacement:
        return input.position_m;
    case InputKind::velocity:
        return input.velocity_m_s;
    case InputKind::temperature:
        return input.temperature_C;
    }
    return 0.0;
}

/// The largest step of the force between neighbours along one range, the rest of `at` fixed.
double steepest_along(const Damper &damper, const InputRange &range, DamperInput at) {
    const double step = (range.max - range.min) / kPoints;
    double &moved = range.kind == InputKind::velocity ? at.velocity_m_s : at.position_m;
    double before_N = 0.0;
    double most = 0.0;
    for (int k = 0; k <= kPoints; ++k) {
        moved = range.min + step * k;
        const double now_N = damper.force_N(at, nullptr, nullptr);
        most = k == 0 ? 0.0 : std::max(most, std::abs(now_N - before_N) / step);
        before_N = now_N;
    }
    return most;
}

} // namespace

Inputs InputBox::picked(const DamperInput &input) const {
    Inputs out{};
    for (std::size_t k = 0; k < count(); ++k) {
        out[k] = value_of(input, ranges_[k].kind);
    }
    return out;
}

Inputs InputBox::clamped(const DamperInput &input) const {
    Inputs out = picked(input);
    for (std::size_t k = 0; k < count(); ++k) {
        out[k] = std::clamp(out[k], ranges_[k].min, ranges_[k].max);
    }
    return out;
}

Inputs InputBox::scaled(const DamperInput &input) const {
    Inputs out = picked(input);
    for (std::size_t k = 0; k < count(); ++k) {
        out[k] = quiesce_scaled(out[k], ranges_[k].min, ranges_[k].max);
    }
    return out;
}

std::array<double, 3> InputBox::spread(InputKind kind, double fallback) const {
    for (const InputRange &range : ranges_) {
        if (range.kind == kind) {
            return {range.min, 0.5 * (range.min + range.max), range.max};
        }
    }
    return {fallback, fallback, fallback};
}

double steepest(const Damper &damper, const InputBox &box, InputKind along, double current_A) {
    const InputKind other =
        along == InputKind::velocity ? InputKind::displacement : InputKind::velocity;
    double most = 0.0;
    for (std::size_t k = 0; k < box.count(); ++k) {
        if (box.range(k).kind != along) {
            continue;
        }
        for (const double temperature_C : box.spread(InputKind::temperature, 25.0)) {
            for (const double value : box.spread(other, 0.0)) {
                DamperInput at{value, value, current_A, 0.0, temperature_C};
                most = std::max(most, steepest_along(damper, box.range(k), at));
            }
        }
    }
    return most;
}

} // namespace quiesce
