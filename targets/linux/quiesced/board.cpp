#include "board.h"

#include <algorithm>

#include "clock.h"

namespace quiesced {

namespace {

constexpr std::uint64_t kSecond_us = 1'000'000;

} // namespace

Board::Board(const Config &config, Exchange &exchange, can_bus_t *bus, watchdog_t *watchdog)
    : config_(config), exchange_(exchange), devices_(exchange.peripherals), log_(exchange.log),
      bus_(bus), watchdog_(watchdog), estop_(config.gpio.estop_input.has_value()) {}

bool Board::read_enable() {
    (void)devices_.enable_input.pick_up();
    EnableInput *input = devices_.enable_input.get();
    bool level = false;
    if (input != nullptr && !input->read(level)) {
        log_.log(LogLevel::error, "enable_input is gone: not enabled");
        devices_.enable_input.give_up();
        return false;
    }
    return level;
}

/// A single reading takes its time: as often as the board says, no more.
void Board::use_rate(std::uint32_t rate_Hz) {
    const quiesce_board_t *wiring = config_.wiring();
    for (std::size_t i = 0; wiring != nullptr && i < config_.sensors.size(); ++i) {
        const auto period_us = static_cast<std::uint64_t>(wiring->sensor[i].period_us);
        const bool is_single = !config_.sensors[i].channel.empty();
        sensors_[i].period_ticks =
            is_single ? static_cast<std::uint32_t>(period_us * rate_Hz / kSecond_us) : 0;
    }
}

bool Board::is_due(std::size_t sensor, std::uint32_t elapsed) {
    SensorWatch &watch = sensors_[sensor];
    if (watch.wait_ticks > elapsed) {
        watch.wait_ticks -= elapsed;
        return false;
    }
    watch.wait_ticks = watch.period_ticks;
    return true;
}

quiesce_sample_t Board::read_sensor(std::size_t sensor, hal_axis_t axis, std::uint32_t elapsed) {
    quiesce_sample_t sample{};
    if (config_.sensors[sensor].source != SensorSource::can && is_due(sensor, elapsed)) {
        SensorDevice *device = devices_.sensors[sensor].get();
        SensorWatch &watch = sensors_[sensor];
        sample.is_fresh =
            device != nullptr && hal_accel_read(&device->handle, axis, &sample.counts);
        watch.silent_ticks =
            sample.is_fresh ? 0 : watch.silent_ticks + std::max(elapsed, watch.period_ticks);
    }
    return sample;
}

quiesce_driver_t Board::read_driver(std::size_t damper) {
    CurrentDevice *device = devices_.outputs[damper].get();
    quiesce_driver_t driver{};
    driver.has_failed = has_failed(damper);
    driver.is_measured = device != nullptr && hal_current_read(&device->handle, &driver.current_mA);
    return driver;
}

node_inputs_t Board::read(const Axes &axes, std::uint32_t elapsed, const hal_tick_t &timing) {
    node_inputs_t inputs{};
    inputs.enable = read_enable();
    inputs.estop = estop_.is_pressed(devices_.estop_input, log_);
    inputs.ticks_elapsed = elapsed;
    inputs.overruns = timing.overruns;
    inputs.lateness_us = timing.lateness_ns / 1000U;
    inputs.work_us = timing.work_ns / 1000U;
    if (bus_ != nullptr) {
        bus_watch_.look(can_bus_state(bus_), monotonic_ns());
        inputs.bus_off_count = can_bus_counters(bus_)->bus_off;
        inputs.rx_lost = can_bus_counters(bus_)->overruns;
    }
    for (std::size_t i = 0; i < config_.sensors.size(); ++i) {
        inputs.sensor[i] = read_sensor(i, axes[i], elapsed);
    }
    for (std::size_t i = 0; i < config_.outputs.size(); ++i) {
        inputs.driver[i] = read_driver(i);
    }
    return inputs;
}

void Board::write_current(std::size_t damper, std::int32_t current_mA, bool enable) {
    CurrentDevice *device = devices_.outputs[damper].get();
    std::int64_t &written_ns = outputs_[damper].written_ns;
    written_ns = 0;
    if (device != nullptr) {
        const std::uint32_t failures = device->failures();
        hal_current_write(&device->handle, current_mA, enable);
        written_ns = device->failures() == failures ? monotonic_ns() : 0;
    }
}

void Board::command_left(std::int64_t demand_ns, bool is_safe, std::uint32_t tick) {
    std::int64_t left_ns = 0;
    for (std::size_t i = 0; i < config_.outputs.size(); ++i) {
        const std::int64_t own_ns = is_on_bus(i) ? demand_ns : outputs_[i].written_ns;
        if (own_ns == 0) { // one that has not left: it is not safe yet
            left_ns = 0;
            break;
        }
        left_ns = std::max(left_ns, own_ns);
    }
    estop_.command_sent(left_ns != 0 && is_safe, left_ns, tick, log_);
}

bool Board::is_on_bus(std::size_t damper) const {
    return config_.outputs[damper].output == CurrentOutput::can;
}

bool Board::is_written(std::size_t damper) {
    CurrentDevice *device = devices_.outputs[damper].get();
    return device != nullptr && device->failures() == outputs_[damper].failures;
}

bool Board::has_failed(std::size_t damper) {
    return is_on_bus(damper) ? bus_watch_.has_failed() : !is_written(damper);
}

/// Whether every driver takes its current now.
bool Board::are_drivable() {
    bool are_all = true;
    for (std::size_t i = 0; i < config_.outputs.size(); ++i) {
        are_all = are_all && (is_on_bus(i) ? bus_watch_.takes_frames() : is_written(i));
    }
    return are_all;
}

void Board::write_lines(bool is_driver_on, bool has_fault, bool rewrite) {
    enable_output_.set(devices_.enable_output, is_driver_on && are_drivable(), rewrite, log_);
    fault_output_.set(devices_.fault_output, has_fault, rewrite, log_);
}

void Board::release_enable_line() {
    enable_output_.set(devices_.enable_output, false, true, log_);
}

void Board::release_fault_line() {
    fault_output_.set(devices_.fault_output, false, true, log_);
}

void Board::look_after_sensor(std::size_t sensor, std::uint32_t rate_Hz) {
    const SensorConfig &config = config_.sensors[sensor];
    SensorWatch &watch = sensors_[sensor];
    if (config.source == SensorSource::can) {
        return;
    }
    if (devices_.sensors[sensor].get() == nullptr) {
        watch.silent_ticks = devices_.sensors[sensor].pick_up() ? 0 : watch.silent_ticks;
    } else if (watch.silent_ticks > rate_Hz) {
        log_.log(LogLevel::error, "%s: no sample for a second; it is opened anew",
                 config.place.title.c_str());
        devices_.sensors[sensor].give_up();
    }
}

void Board::look_after_output(std::size_t damper, bool once_a_second, ChangeLog &changes) {
    auto &output = devices_.outputs[damper];
    CurrentDevice *device = output.get();
    OutputWatch &watch = outputs_[damper];
    if (device == nullptr) {
        if (output.pick_up()) {
            watch.failures = 0;
        }
        return;
    }
    const char *title = config_.outputs[damper].place.title.c_str();
    const std::uint32_t failures = device->failures();
    changes.failed_writes(damper, title, failures, monotonic_ns());
    if (once_a_second) {
        if (failures != watch.failures) {
            log_.log(LogLevel::error, "%s: it is opened anew", title);
            output.give_up();
        }
        watch.failures = failures;
    }
}

/// What it takes to get the bus back may wait: it is the other thread's.
void Board::look_after_bus() {
    if (bus_ != nullptr && can_bus_maintain(bus_, monotonic_ns())) {
        exchange_.wake();
    }
}

void Board::look_after(std::uint32_t rate_Hz, bool once_a_second, ChangeLog &changes) {
    for (std::size_t i = 0; i < config_.sensors.size(); ++i) {
        look_after_sensor(i, rate_Hz);
    }
    for (std::size_t i = 0; i < config_.outputs.size(); ++i) {
        look_after_output(i, once_a_second, changes);
    }
    (void)devices_.data_ready_input.pick_up();
    look_after_bus();
    if (bus_ != nullptr && once_a_second) {
        can_bus_look(bus_);
    }
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
