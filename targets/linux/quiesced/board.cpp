#include "board.h"

#include "clock.h"

namespace quiesced {

namespace {

constexpr int kMaxEdges = 64; // a tick; the rest waits for the next one

} // namespace

Board::Board(const Config &config, Exchange &exchange, can_bus_t *bus, watchdog_t *watchdog)
    : config_(config), exchange_(exchange), devices_(exchange.peripherals), log_(exchange.log),
      bus_(bus), watchdog_(watchdog), estop_(config.gpio.estop_input.has_value()) {}

bool Board::read_enable() {
    if (!config_.gpio.enable_input) {
        return true;
    }
    (void)devices_.enable_input.pick_up();
    bool level = false;
    gpio_line_t *line = devices_.enable_input.get();
    if (line != nullptr && !gpio_get(line, &level)) {
        log_.log(LogLevel::error, "enable_input is gone: not enabled");
        devices_.enable_input.give_up();
        return false;
    }
    // Nobody reads its edges; they must not pile up.
    gpio_edge_t edge;
    for (int i = 0; line != nullptr && i < kMaxEdges && gpio_next_edge(line, &edge); ++i) {
    }
    return level;
}

void Board::read_accel(hal_axis_t axis, node_inputs_t &inputs) {
    if (config_.accel.source == AccelSource::can) {
        return;
    }
    AccelDevice *device = devices_.accel.get();
    inputs.accel_is_fresh =
        device != nullptr && hal_accel_read(&device->handle, axis, &inputs.accel_counts);
    silent_ticks_ = inputs.accel_is_fresh ? 0 : silent_ticks_ + 1;
}

void Board::read_current(node_inputs_t &inputs) {
    CurrentDevice *device = devices_.current.get();
    inputs.current_is_measured =
        device != nullptr && hal_current_read(&device->handle, &inputs.current_meas_mA);
}

node_inputs_t Board::read(hal_axis_t axis, std::uint32_t elapsed, const hal_tick_t &timing) {
    node_inputs_t inputs{};
    inputs.enable = read_enable();
    inputs.estop = estop_.is_pressed(devices_.estop_input, log_);
    inputs.driver_has_failed = !is_drivable();
    inputs.ticks_elapsed = elapsed;
    inputs.overruns = timing.overruns;
    inputs.lateness_us = timing.lateness_ns / 1000U;
    inputs.work_us = timing.work_ns / 1000U;
    if (bus_ != nullptr) {
        inputs.tx_dropped = can_bus_counters(bus_)->tx_dropped;
        inputs.bus_off_count = can_bus_counters(bus_)->bus_off;
    }
    read_accel(axis, inputs);
    read_current(inputs);
    return inputs;
}

void Board::write_current(std::int32_t current_mA, bool enable) {
    CurrentDevice *device = devices_.current.get();
    written_ns_ = 0;
    if (device != nullptr) {
        const std::uint32_t failures = device->failures();
        hal_current_write(&device->handle, current_mA, enable);
        written_ns_ = device->failures() == failures ? monotonic_ns() : 0;
    }
}

void Board::command_left(std::int64_t demand_ns, bool is_safe, std::uint32_t tick) {
    const std::int64_t left_ns =
        config_.current.output == CurrentOutput::can ? demand_ns : written_ns_;
    estop_.command_sent(left_ns != 0 && is_safe, left_ns, tick, log_);
}

/// Whether the driver takes its current: a CAN driver looks after itself.
bool Board::is_drivable() {
    if (config_.current.output == CurrentOutput::can) {
        return true;
    }
    CurrentDevice *device = devices_.current.get();
    return device != nullptr && device->failures() == current_failures_;
}

void Board::write_lines(bool is_driver_on, bool has_fault, bool rewrite) {
    enable_output_.set(devices_.enable_output, is_driver_on && is_drivable(), rewrite, log_);
    fault_output_.set(devices_.fault_output, has_fault, rewrite, log_);
}

void Board::release_enable_line() {
    enable_output_.set(devices_.enable_output, false, true, log_);
}

void Board::release_fault_line() {
    fault_output_.set(devices_.fault_output, false, true, log_);
}

void Board::look_after_accel(std::uint32_t rate_Hz) {
    if (config_.accel.source == AccelSource::can) {
        return;
    }
    if (devices_.accel.get() == nullptr) {
        silent_ticks_ = devices_.accel.pick_up() ? 0 : silent_ticks_;
    } else if (silent_ticks_ > rate_Hz) {
        log_.log(LogLevel::error, "accelerometer: no sample for a second; it is opened anew");
        devices_.accel.give_up();
    }
}

void Board::look_after_current(bool once_a_second, ChangeLog &changes) {
    CurrentDevice *device = devices_.current.get();
    if (device == nullptr) {
        if (devices_.current.pick_up()) {
            current_failures_ = 0;
        }
        return;
    }
    const std::uint32_t failures = device->failures();
    changes.failed_writes(failures, monotonic_ns());
    if (once_a_second) {
        if (failures != current_failures_) {
            log_.log(LogLevel::error, "current output: it is opened anew");
            devices_.current.give_up();
        }
        current_failures_ = failures;
    }
}

/// What it takes to get the bus back may wait: it is the other thread's.
void Board::look_after_bus() {
    if (bus_ != nullptr && can_bus_maintain(bus_, monotonic_ns())) {
        exchange_.wake();
    }
}

void Board::look_after(std::uint32_t rate_Hz, bool once_a_second, ChangeLog &changes) {
    look_after_accel(rate_Hz);
    look_after_current(once_a_second, changes);
    (void)devices_.data_ready_input.pick_up();
    look_after_bus();
    feed_watchdogs(monotonic_ns());
}

/// Both say that the loop goes on; the disk, which the other thread may wait for, has no part in
/// it.
void Board::feed_watchdogs(std::int64_t now_ns) {
    if (watchdog_ != nullptr) {
        watchdog_feed(watchdog_, now_ns);
    }
    const Notifier &manager = exchange_.manager;
    if (manager.watchdog_period_ns() > 0 && now_ns >= next_notice_ns_) {
        next_notice_ns_ = now_ns + manager.watchdog_period_ns();
        manager.send("WATCHDOG=1");
    }
}

} // namespace quiesced
