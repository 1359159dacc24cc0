/// The emergency-stop input. It is read by its edges, so that a press shorter than a tick counts,
/// and by its level; where the line is gone it counts as pressed.
#ifndef QUIESCED_EMERGENCY_STOP_H
#define QUIESCED_EMERGENCY_STOP_H

#include "exchange.h"

namespace quiesced {

class EmergencyStop {
  public:
    /// is_used: there is such a line.
    explicit EmergencyStop(bool is_used) : is_used_(is_used) {}

    /// Once a tick: was it pressed since the last one? Logs the first edge of a press with the
    /// kernel's time stamp.
    bool is_pressed(Replaceable<Line> &line, LogRing &log);

    /// Once a tick. is_safe: the tick's command has left, at this time, and was the safe current
    /// with the driver off. Logs the first of them after an edge.
    void command_sent(bool is_safe, std::int64_t time_ns, std::uint32_t tick, LogRing &log);

  private:
    bool take_edges(gpio_line_t *line, LogRing &log);

    bool is_used_;
    bool was_pressed_ = false;
    bool awaits_safe_command_ = false;
    std::uint32_t ticks_since_edge_ = 0;
};

} // namespace quiesced

#endif
