#include "random_segment.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include <unsupported/Eigen/FFT>

#include "noise.h"

namespace quiesce {

namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kFewestLines = 200.0;
constexpr double kPointsPerCycle = 64.0;

/// Lines first .. first + values.size() - 1 of the drive, unit RMS: sum of Re(value e^(i w t)).
struct Lines {
    std::size_t first;
    std::vector<Complex> values;
};

Lines random_lines(const RandomParams &params, double period_s) {
    Noise noise(params.seed);
    const auto first = static_cast<std::size_t>(std::ceil(params.low_Hz * period_s));
    const auto last = static_cast<std::size_t>(std::floor(params.high_Hz * period_s));
    Lines lines{first, {}};
    double mean_square = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
        const double cosine = noise.gaussian();
        const double sine = noise.gaussian();
        lines.values.emplace_back(cosine, sine);
        mean_square += 0.5 * (cosine * cosine + sine * sine);
    }
    for (Complex &value : lines.values) {
        value /= std::sqrt(mean_square);
    }
    return lines;
}

std::size_t power_of_two_from(double count) {
    std::size_t out = 1;
    while (static_cast<double>(out) < count) {
        out *= 2;
    }
    return out;
}

} // namespace

double RandomSegment::repeat_s(const RandomParams &params) {
    return std::max(params.least_repeat_s, kFewestLines / (params.high_Hz - params.low_Hz));
}

RandomSegment::RandomSegment(const ShakerParams &shaker_params, const RandomParams &params)
    : shaker_(shaker_params) {
    const double period_s = repeat_s(params);
    const std::size_t count = power_of_two_from(kPointsPerCycle * params.high_Hz * period_s);
    const Lines lines = random_lines(params, period_s);
    // The real part of the transform is the value, the imaginary part its slope.
    std::vector<Complex> spectrum(count);
    for (std::size_t i = 0; i < lines.values.size(); ++i) {
        const std::size_t line = lines.first + i;
        const double freq_Hz = static_cast<double>(line) / period_s;
        const double turn = kTwoPi * static_cast<double>(line) / static_cast<double>(count);
        const Complex half = 0.5 * shaker_.amplitude(freq_Hz, params.drive_rms_V) * lines.values[i];
        spectrum[line] = half * (1.0 - turn);
        spectrum[count - line] = std::conj(half) * (1.0 + turn);
    }
    Eigen::FFT<double> fft;
    fft.SetFlag(Eigen::FFT<double>::Unscaled);
    std::vector<Complex> points;
    fft.inv(points, spectrum);
    points_per_s_ = static_cast<double>(count) / period_s;
    table_.reserve(count);
    for (const Complex &point : points) {
        table_.push_back({point.real(), point.imag()});
    }
}

ExcitationSample RandomSegment::sample(double time_s, double start_cycles) const {
    const double at = time_s * points_per_s_;
    const double floor = std::floor(at);
    const auto index = static_cast<std::size_t>(floor) & (table_.size() - 1);
    const Point &from = table_[index];
    const Point &to = table_[(index + 1) & (table_.size() - 1)];
    const double u = at - floor;
    const double rise = to.value - from.value;
    const double value =
        from.value + u * (from.slope + u * (3.0 * rise - 2.0 * from.slope - to.slope +
                                            u * (from.slope + to.slope - 2.0 * rise)));
    return shaker_.sample(value, 0.0, start_cycles);
}

} // namespace quiesce
