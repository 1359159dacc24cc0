#include "pace.h"

#include <algorithm>

namespace quiesce {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kMostLate_ns = kSecond_ns / 4; // a machine that was suspended, a debugger

} // namespace

std::int64_t Pace::due_ns() const {
    const std::int64_t seconds = since_start_ / rate_Hz_;
    const std::int64_t rest = since_start_ % rate_Hz_;
    return start_ns_ + seconds * kSecond_ns + rest * kSecond_ns / rate_Hz_;
}

void Pace::begin(std::int64_t now_ns) {
    const std::int64_t late_ns = std::max<std::int64_t>(0, now_ns - due_ns());
    lateness_us_ = late_ns / 1000;
    latest_us_ = std::max(latest_us_, lateness_us_);
    overruns_ += late_ns * rate_Hz_ >= kSecond_ns ? 1u : 0u;
    std::size_t bin = 0;
    while (bin + 1 < kBins && lateness_us_ >> bin != 0) {
        ++bin;
    }
    ++bins_[bin];
    ++ticks_;
    ++since_start_;
    if (late_ns > kMostLate_ns) {
        lost_ns_ += late_ns;
        change_rate(rate_Hz_, now_ns);
    }
}

void Pace::change_rate(std::int64_t rate_Hz, std::int64_t now_ns) {
    rate_Hz_ = rate_Hz;
    start_ns_ = now_ns;
    since_start_ = 1;
}

} // namespace quiesce
