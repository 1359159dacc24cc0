/// Sum of sines of any frequencies: amplitude sin(2 pi f t + phase) each.
#ifndef QUIESCE_TONE_SUM_H
#define QUIESCE_TONE_SUM_H

#include <cmath>
#include <vector>

namespace quiesce {

struct ToneLine {
    double freq_Hz;
    double amplitude;
    double phase_cycles;
};

inline double sum_of_tones(const std::vector<ToneLine> &lines, double time_s) {
    constexpr double kTwoPi = 6.28318530717958647692;
    double sum = 0.0;
    for (const ToneLine &line : lines) {
        const double cycles = line.freq_Hz * time_s + line.phase_cycles;
        sum += line.amplitude * std::sin(kTwoPi * (cycles - std::floor(cycles)));
    }
    return sum;
}

} // namespace quiesce

#endif
