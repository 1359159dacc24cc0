#include "edge_rate.h"

#include <cmath>

namespace quiesced {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kTolerance = 0.02;
constexpr int kInARow = 3;

} // namespace

void EdgeRate::start(std::uint32_t expected_Hz) {
    *this = EdgeRate{};
    expected_Hz_ = expected_Hz;
}

bool EdgeRate::count(std::uint32_t edges, std::int64_t time_ns) {
    edges_ += has_start_ ? edges : 0;
    start_ns_ = has_start_ ? start_ns_ : time_ns;
    has_start_ = true;
    const std::int64_t span_ns = time_ns - start_ns_;
    if (span_ns < kSecond_ns) {
        return false;
    }
    const double rate_Hz = edges_ * 1e9 / static_cast<double>(span_ns);
    rate_Hz_ = static_cast<std::uint32_t>(std::lround(rate_Hz));
    start_ns_ = time_ns;
    edges_ = 0;
    const bool is_off = std::abs(rate_Hz / expected_Hz_ - 1.0) > kTolerance;
    in_a_row_ = is_off != is_off_ ? in_a_row_ + 1 : 0;
    if (in_a_row_ < kInARow) {
        return false;
    }
    in_a_row_ = 0;
    is_off_ = is_off;
    return true;
}

} // namespace quiesced
