/// Motions to run a damper over, and what comes of them.
#ifndef QUIESCE_TEST_DAMPER_MOTION_H
#define QUIESCE_TEST_DAMPER_MOTION_H

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "damper.h"
#include "damper_over_motion.h"
#include "kernel_damper.h"
#include "motion_grid.h"
#include "noise.h"

namespace quiesce {

struct Samples {
    double step_s = 0.0;
    std::vector<double> x, v, a, current;

    void add(double disp_m, double velocity_m_s, double accel_m_s2, double current_A) {
        x.push_back(disp_m);
        v.push_back(velocity_m_s);
        a.push_back(accel_m_s2);
        current.push_back(current_A);
    }
    MotionGrid grid(int substeps) const {
        return MotionGrid({x.size(), step_s, x.data(), v.data(), a.data(), current.data()},
                          substeps);
    }
    double fastest_m_s() const {
        double fastest = 0.0;
        for (const double one : v) {
            fastest = std::max(fastest, std::abs(one));
        }
        return fastest;
    }
};

inline std::vector<double> run(const Damper &damper, const Samples &samples, int substeps) {
    std::vector<double> force(samples.x.size());
    damper_over_motion(damper, samples.grid(substeps), force.data());
    return force;
}

/// Steps in which the damper's own rate is at most `part` a step.
inline int substeps_for(const Damper &damper, const Samples &samples, double part = 0.5) {
    double rate = 1.0;
    for (const double current_A : {samples.current.front(), samples.current.back()}) {
        rate = std::max(rate, damper.fastest_rate_1_s(current_A));
    }
    return std::clamp(static_cast<int>(std::ceil(rate * samples.step_s / part)), 1, 10000);
}

/// x = amplitude sin(2 pi freq t).
inline Samples sine(double amplitude_m, double freq_Hz, double current_A, int cycles,
                    int per_cycle = 400) {
    Samples out;
    out.step_s = 1.0 / (freq_Hz * per_cycle);
    const double w = 2.0 * 3.14159265358979323846 * freq_Hz;
    for (int k = 0; k <= cycles * per_cycle; ++k) {
        const double phase = w * out.step_s * k;
        out.add(amplitude_m * std::sin(phase), amplitude_m * w * std::cos(phase),
                -amplitude_m * w * w * std::sin(phase), current_A);
    }
    return out;
}

/// Constant velocity from x = 0.
inline Samples ramp(double velocity_m_s, double length_m, int count) {
    Samples out;
    out.step_s = length_m / std::abs(velocity_m_s) / count;
    for (int k = 0; k <= count; ++k) {
        out.add(velocity_m_s * out.step_s * k, velocity_m_s, 0.0, 0.0);
    }
    return out;
}

/// Four sines of random amplitude (up to amplitude_m each) and frequency (1 to 10 Hz), from x = 0.
inline Samples random_motion(double amplitude_m, Noise &random, int count = 2000) {
    const auto uniform = [&random] { return static_cast<double>(random.bits() >> 11) * 0x1p-53; };
    std::array<double, 4> size{};
    std::array<double, 4> w{};
    for (std::size_t k = 0; k < size.size(); ++k) {
        size[k] = amplitude_m * (2.0 * uniform() - 1.0);
        w[k] = 2.0 * 3.14159265358979323846 * (1.0 + 9.0 * uniform());
    }
    Samples out;
    out.step_s = 1e-3;
    for (int i = 0; i < count; ++i) {
        const double t = out.step_s * i;
        double x = 0.0;
        double v = 0.0;
        double a = 0.0;
        for (std::size_t k = 0; k < size.size(); ++k) {
            x += size[k] * std::sin(w[k] * t);
            v += size[k] * w[k] * std::cos(w[k] * t);
            a -= size[k] * w[k] * w[k] * std::sin(w[k] * t);
        }
        out.add(x, v, a, 0.0);
    }
    return out;
}

struct Loop {
    double max_N;
    double min_N;
    double area_J; ///< of force against displacement, > 0 where energy is taken
    double half_range_N() const { return 0.5 * (max_N - min_N); }
};

/// The last of some cycles of a sine.
inline Loop sine_loop(const Damper &damper, double amplitude_m, double freq_Hz, double current_A,
                      int cycles = 3) {
    const Samples samples = sine(amplitude_m, freq_Hz, current_A, cycles);
    const std::vector<double> force = run(damper, samples, substeps_for(damper, samples));
    const std::size_t end = force.size() - 1;
    const std::size_t first = end - end / static_cast<std::size_t>(cycles);
    Loop loop{force[end], force[end], 0.0};
    for (std::size_t k = first; k < end; ++k) {
        loop.max_N = std::max(loop.max_N, force[k]);
        loop.min_N = std::min(loop.min_N, force[k]);
        loop.area_J += force[k] * samples.v[k] * samples.step_s;
    }
    return loop;
}

/// A kernel with parameters that do not follow the current.
template <class Kernel>
KernelDamper<Kernel> constant(const std::array<double, Kernel::kParameters.size()> &p,
                              double speed_m_s = 1.0) {
    std::array<CurrentLaw, Kernel::kParameters.size()> laws{};
    for (std::size_t k = 0; k < p.size(); ++k) {
        laws[k] = {p[k], 0.0, 0.0};
    }
    return {laws.data(), 1.0, speed_m_s};
}

/// Random parameters in the search range, for a damper of 1 kN, 10 mm and 0.3 m/s.
template <class Kernel>
std::array<double, Kernel::kParameters.size()> random_parameters(Noise &random) {
    std::array<double, Kernel::kParameters.size()> p{};
    for (std::size_t k = 0; k < p.size(); ++k) {
        const ParameterInfo &info = Kernel::kParameters[k];
        const double natural = std::pow(1000.0, info.scale.force) *
                               std::pow(0.01, info.scale.disp) * std::pow(0.3, info.scale.speed);
        const double part = static_cast<double>(random.bits() >> 11) * 0x1p-53;
        const double value =
            natural * (info.search_low + part * (info.search_high - info.search_low));
        p[k] = std::clamp(value, info.min, info.max);
    }
    return p;
}

} // namespace quiesce

#endif
