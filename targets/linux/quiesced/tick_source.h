/// When a control tick starts: with the timer, or with the edge of a data-ready line.
#ifndef QUIESCED_TICK_SOURCE_H
#define QUIESCED_TICK_SOURCE_H

#include "edge_rate.h"
#include "exchange.h"

namespace quiesced {

class TickSource {
  public:
    TickSource() = default;
    TickSource(const TickSource &) = delete;
    TickSource &operator=(const TickSource &) = delete;
    virtual ~TickSource() = default;

    /// Starts the timer. has_line: the line's edges start ticks instead.
    void start(std::uint32_t rate_Hz, bool has_line);

    /// Goes on at another rate; counts and histograms stay.
    void change_rate(std::uint32_t rate_Hz);

    /// Waits for the next tick. Returns how many have elapsed: 1, more where ticks were lost, 0
    /// where a signal came first. Edges that come too early are counted, not taken
    /// (tick_linux_begin); without one the tick starts after two periods, one of them lost. A rate
    /// that stays off is logged once. Gives the line up where the kernel has lost it.
    virtual std::uint32_t wait(Replaceable<Line> &line, LogRing &log);

    /// The tick's work is done.
    void done() { tick_linux_work_done(&timing_); }

    const hal_tick_t &timing() const { return timing_; }

  private:
    std::uint32_t wait_for_edge(Replaceable<Line> &line, LogRing &log);
    bool take_edges(gpio_line_t *line, std::int64_t &time_ns, LogRing &log);
    std::uint32_t begin(std::int64_t due_ns);
    void log_rate(LogRing &log) const;

    hal_tick_t timing_{};
    EdgeRate edge_rate_;
    std::uint32_t rate_Hz_ = 0;
    bool has_line_ = false;
};

} // namespace quiesced

#endif
