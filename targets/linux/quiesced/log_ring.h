/// Lines of the control loop's log on their way to the thread that writes them. The loop never
/// waits: where the ring is full the line is dropped and counted.
#ifndef QUIESCED_LOG_RING_H
#define QUIESCED_LOG_RING_H

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "config.h"

namespace quiesced {

struct LogLine {
    static constexpr std::size_t kBytes = 232;
    LogLevel level;
    std::int64_t time_ns; ///< CLOCK_REALTIME
    std::array<char, kBytes> text;
};

class LogRing {
  public:
    static constexpr std::size_t kLines = 1024;

    /// Writer's thread. Formats the line (cut where it is too long); printf's conversions of
    /// integers and text only, which need no heap.
    __attribute__((format(printf, 3, 4))) void log(LogLevel level, const char *format, ...);

    /// Reader's thread. Returns false iff there is none.
    bool take(LogLine &line);

    /// Lines dropped since the start.
    std::uint32_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

    bool is_empty() const { return written_.load() == taken_.load(); }

  private:
    std::array<LogLine, kLines> lines_{};
    std::atomic<std::size_t> written_{0};
    std::atomic<std::size_t> taken_{0};
    std::atomic<std::uint32_t> dropped_{0};
};

} // namespace quiesced

#endif
