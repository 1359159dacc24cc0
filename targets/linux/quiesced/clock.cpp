#include "clock.h"

#include <array>
#include <cstdio>
#include <ctime>

namespace quiesced {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t now_ns(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<std::int64_t>(now.tv_sec) * kSecond_ns + now.tv_nsec;
}

} // namespace

std::int64_t monotonic_ns() {
    return now_ns(CLOCK_MONOTONIC);
}

std::int64_t realtime_ns() {
    return now_ns(CLOCK_REALTIME);
}

std::string iso_time(std::int64_t realtime_ns) {
    const auto seconds = static_cast<time_t>(realtime_ns / kSecond_ns);
    tm utc{};
    gmtime_r(&seconds, &utc);
    std::array<char, 40> text{};
    const std::size_t used = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
    (void)std::snprintf(text.data() + used, text.size() - used, ".%03dZ",
                        static_cast<int>(realtime_ns % kSecond_ns / 1'000'000));
    return text.data();
}

void sleep_ms(int duration_ms) {
    const timespec pause = {duration_ms / 1000, duration_ms % 1000 * 1'000'000L};
    (void)clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, nullptr);
}

} // namespace quiesced
