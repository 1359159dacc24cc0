#include "log_ring.h"

#include <cstdarg>
#include <cstdio>

#include "clock.h"

namespace quiesced {

// The compiler checks its arguments as printf's. NOLINTNEXTLINE(cert-dcl50-cpp)
void LogRing::log(LogLevel level, const char *format, ...) {
    const std::size_t written = written_.load(std::memory_order_relaxed);
    if (written - taken_.load(std::memory_order_acquire) >= kLines) {
        dropped_.fetch_add(1, std::memory_order_relaxed);
        return;
    }
    LogLine &line = lines_[written % kLines];
    line.level = level;
    line.time_ns = realtime_ns();
    va_list arguments;
    va_start(arguments, format);
    (void)std::vsnprintf(line.text.data(), line.text.size(), format, arguments);
    va_end(arguments);
    written_.store(written + 1, std::memory_order_release);
}

bool LogRing::take(LogLine &line) {
    const std::size_t taken = taken_.load(std::memory_order_relaxed);
    if (taken == written_.load(std::memory_order_acquire)) {
        return false;
    }
    line = lines_[taken % kLines];
    taken_.store(taken + 1, std::memory_order_release);
    return true;
}

} // namespace quiesced
