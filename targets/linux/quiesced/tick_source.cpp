#include "tick_source.h"

#include <algorithm>
#include <cerrno>

#include <poll.h>

#include "clock.h"

namespace quiesced {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Returns what ppoll does.
int wait_readable(int fd, std::int64_t duration_ns, short &found) {
    pollfd ready = {fd, POLLIN, 0};
    const std::int64_t pause_ns = std::max<std::int64_t>(duration_ns, 0);
    const timespec pause = {static_cast<time_t>(pause_ns / kSecond_ns),
                            static_cast<long>(pause_ns % kSecond_ns)};
    const int count = ppoll(&ready, fd < 0 ? 0 : 1, &pause, nullptr);
    found = ready.revents;
    return count;
}

} // namespace

void TickSource::start(std::uint32_t rate_Hz, bool has_line) {
    has_line_ = has_line;
    timing_ = hal_tick_t{};
    rate_Hz_ = rate_Hz;
    edge_rate_.start(rate_Hz);
    (void)hal_tick_start(&timing_, rate_Hz); // all rates that a parameter may have can be made
}

void TickSource::change_rate(std::uint32_t rate_Hz) {
    const hal_tick_t before = timing_;
    rate_Hz_ = rate_Hz;
    edge_rate_.start(rate_Hz);
    (void)hal_tick_start(&timing_, rate_Hz);
    timing_.overruns = before.overruns;
    timing_.early = before.early;
    timing_.lateness = before.lateness;
    timing_.work = before.work;
    timing_.lateness_ns = before.lateness_ns;
    timing_.work_ns = before.work_ns;
}

std::uint32_t TickSource::wait(Replaceable<Line> &line, LogRing &log) {
    if (has_line_) {
        return wait_for_edge(line, log);
    }
    tick_linux_wait(&timing_);
    return hal_tick_elapsed(&timing_);
}

std::uint32_t TickSource::begin(std::int64_t due_ns) {
    (void)tick_linux_begin(&timing_, due_ns);
    return hal_tick_elapsed(&timing_);
}

void TickSource::log_rate(LogRing &log) const {
    if (edge_rate_.is_off()) {
        log.log(LogLevel::error,
                "data_ready_input: %u edges a second, tick_rate_Hz is %u; ticks keep to "
                "tick_rate_Hz, set the sensor's rate to it",
                static_cast<unsigned>(edge_rate_.rate_Hz()), static_cast<unsigned>(rate_Hz_));
    } else {
        log.log(LogLevel::info, "data_ready_input: %u edges a second, as tick_rate_Hz",
                static_cast<unsigned>(edge_rate_.rate_Hz()));
    }
}

/// Returns false iff no edge has come since the last call; else the newest one's time.
bool TickSource::take_edges(gpio_line_t *line, std::int64_t &time_ns, LogRing &log) {
    constexpr int most = 64; // edges a tick: the loop stays bounded
    gpio_edge_t edge{};
    std::uint32_t edges = 0;
    for (int i = 0; i < most && gpio_next_edge(line, &edge); ++i) {
        if (edge.is_active) {
            time_ns = edge.time_ns;
            ++edges;
        }
    }
    if (edges > 0 && edge_rate_.count(edges, time_ns)) {
        log_rate(log);
    }
    return edges > 0;
}

std::uint32_t TickSource::wait_for_edge(Replaceable<Line> &line, LogRing &log) {
    const std::int64_t deadline_ns = monotonic_ns() + 2 * std::int64_t{timing_.period_ns};
    for (;;) {
        const int fd = line.get() == nullptr ? -1 : gpio_fd(line.get());
        short found = 0;
        const int count = wait_readable(fd, deadline_ns - monotonic_ns(), found);
        if (count < 0 && errno == EINTR) {
            return 0;
        }
        if (count <= 0) {
            return begin(monotonic_ns());
        }
        std::int64_t time_ns = 0;
        if (take_edges(line.get(), time_ns, log)) {
            const std::uint32_t elapsed = begin(time_ns);
            if (elapsed > 0) {
                return elapsed;
            }
            continue; // too early
        }
        bool level = false;
        if ((found & (POLLERR | POLLHUP | POLLNVAL)) != 0 || !gpio_get(line.get(), &level)) {
            log.log(LogLevel::error, "data_ready_input is gone: ticks come from a timeout");
            line.give_up();
        }
    }
}

} // namespace quiesced
