/// The two clocks: CLOCK_MONOTONIC for everything that is measured, CLOCK_REALTIME for people.
#ifndef QUIESCED_CLOCK_H
#define QUIESCED_CLOCK_H

#include <cstdint>
#include <string>

namespace quiesced {

std::int64_t monotonic_ns();
std::int64_t realtime_ns();

/// "2026-05-01T12:00:00.123Z"
std::string iso_time(std::int64_t realtime_ns);

void sleep_ms(int duration_ms);

} // namespace quiesced

#endif
