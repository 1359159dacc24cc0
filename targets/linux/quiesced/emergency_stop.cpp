#include "emergency_stop.h"

namespace quiesced {

namespace {

constexpr int kMaxEdges = 64; // of a tick: a line that bounces must not hold the loop

} // namespace

bool EmergencyStop::take_edges(gpio_line_t *line, LogRing &log) {
    bool was_pressed = false;
    gpio_edge_t edge{};
    for (int i = 0; i < kMaxEdges && gpio_next_edge(line, &edge); ++i) {
        if (edge.is_active && !was_pressed && !was_pressed_) {
            log.log(LogLevel::error, "emergency stop: edge at %lld ns",
                    static_cast<long long>(edge.time_ns));
            awaits_safe_command_ = true;
            ticks_since_edge_ = 0;
        }
        was_pressed = was_pressed || edge.is_active;
    }
    return was_pressed;
}

bool EmergencyStop::is_pressed(Replaceable<Line> &line, LogRing &log) {
    if (!is_used_) {
        return false;
    }
    (void)line.pick_up();
    bool level = true;
    bool is_pressed = line.get() == nullptr;
    if (!is_pressed) {
        is_pressed = take_edges(line.get(), log);
        if (!gpio_get(line.get(), &level)) {
            log.log(LogLevel::error, "estop_input is gone: counts as pressed");
            line.give_up();
            level = true;
        }
    }
    was_pressed_ = is_pressed || level;
    return was_pressed_;
}

void EmergencyStop::command_sent(bool is_safe, std::int64_t time_ns, std::uint32_t tick,
                                 LogRing &log) {
    if (!awaits_safe_command_) {
        return;
    }
    ++ticks_since_edge_;
    if (is_safe) {
        awaits_safe_command_ = false;
        log.log(LogLevel::error,
                "emergency stop: safe current sent at %lld ns in tick %u, %u after the edge",
                static_cast<long long>(time_ns), static_cast<unsigned>(tick),
                static_cast<unsigned>(ticks_since_edge_));
    }
}

} // namespace quiesced
