#include "loop.h"

#include "board_fit.h"
#include "clock.h"
#include "frame_sender.h"
#include "names.h"
#include "signals.h"

namespace quiesced {

namespace {

constexpr int kMaxReceived = 64; // frames a tick; the rest waits for the next one
constexpr std::uint32_t kAdaptationEvery_s = 60;
constexpr int kFarewells = 3; // one might be lost
constexpr int kFarewellPause_ms = 2;
constexpr int kFarewellPatience_ms = 200; // well below the least timeout of a watchdog
constexpr int kLastAttempts = 1000;       // a millisecond apart

} // namespace

Loop::Loop(const Config &config, const quiesce_params_t &params, Exchange &exchange, can_bus_t *bus,
           watchdog_t *watchdog)
    : config_(config), exchange_(exchange), devices_(exchange.peripherals), log_(exchange.log),
      bus_(bus), watchdog_(watchdog), latch_(exchange), estop_(config.gpio.estop_input.has_value()),
      changes_(exchange.log) {
    accel_ = {read_accel, this};
    current_ = {write_current, read_current, this};
    (void)node_init(&node_, &params, config.enable_from, &accel_, &current_);
    node_.store = store;
    node_.store_context = this;
    node_.store_is_slow = true;
}

bool Loop::read_accel(void *self, hal_axis_t axis, std::int32_t *counts) {
    auto &loop = *static_cast<Loop *>(self);
    if (loop.config_.accel.source == AccelSource::can) {
        return node_accel_sample(&loop.node_, counts);
    }
    AccelDevice *device = loop.devices_.accel.get();
    const bool is_fresh = device != nullptr && hal_accel_read(&device->handle, axis, counts);
    loop.silent_ticks_ = is_fresh ? 0 : loop.silent_ticks_ + 1;
    return is_fresh;
}

void Loop::write_current(void *self, std::int32_t current_mA, bool enable) {
    auto &loop = *static_cast<Loop *>(self);
    CurrentDevice *device = loop.devices_.current.get();
    loop.is_written_ = false;
    if (device != nullptr) {
        const std::uint32_t failures = device->failures();
        hal_current_write(&device->handle, current_mA, enable && !loop.latch_.is_holding());
        loop.is_written_ = device->failures() == failures;
    }
}

bool Loop::read_current(void *self, std::int32_t *current_mA) {
    auto &loop = *static_cast<Loop *>(self);
    CurrentDevice *device = loop.devices_.current.get();
    return (device != nullptr && hal_current_read(&device->handle, current_mA)) ||
           node_current_measured(&loop.node_, current_mA);
}

/// Called every tick until it is answered.
bool Loop::store(void *self, const quiesce_params_t *params) {
    auto &loop = *static_cast<Loop *>(self);
    if (!loop.store_is_pending_ && loop.exchange_.to_store.put(*params)) {
        loop.store_is_pending_ = true;
        loop.exchange_.wake();
    }
    return true;
}

void Loop::answer_store() {
    const StoreResult result = exchange_.store_result.exchange(StoreResult::none);
    if (store_is_pending_ && result != StoreResult::none) {
        store_is_pending_ = false;
        can_node_answer(&node_.can,
                        result == StoreResult::stored ? CAN_NODE_DONE : CAN_NODE_STORE_FAILED, 0);
    }
}

void Loop::use_adaptation(const quiesce_adaptation_t &adaptation) {
    if (node_.params.law != QUIESCE_LAW_PHASE) {
        return;
    }
    const bool is_used = quiesce_adaptation_load(&node_.app.controller, &adaptation);
    log_.log(LogLevel::info, is_used ? "what was learnt before is used"
                                     : "what was learnt before belongs to other parameters");
}

void Loop::keep_adaptation() {
    has_adaptation_ = node_.params.law == QUIESCE_LAW_PHASE;
    if (has_adaptation_) {
        quiesce_adaptation_save(&node_.app.controller, &adaptation_);
    }
}

/// What the node does not know: what the board can do.
void Loop::prepare_apply() {
    if (can_node_task(&node_.can) != CAN_NODE_APPLY) {
        return;
    }
    keep_adaptation();
    const std::optional<Misfit> misfit = find_misfit(config_, *can_node_staged(&node_.can));
    if (misfit && latched_fault(node_) == QUIESCE_FAULT_NONE) {
        can_node_answer(&node_.can, CAN_NODE_CONTRADICTION, misfit->index);
        log_.log(LogLevel::error, "parameters stay: %s", misfit->reason.data());
    }
}

void Loop::use_params(const quiesce_params_t &params) {
    if (latched_fault(node_) != QUIESCE_FAULT_NONE) { // a restart would forget it
        log_.log(LogLevel::error, "parameters stay: a fault is latched; acknowledge it first");
        return;
    }
    quiesce_param_error_t error{};
    keep_adaptation();
    if (!node_use_params(&node_, &params, &error)) {
        log_.log(LogLevel::error, "parameters stay: %s: %s", error.name, error.reason);
    }
}

void Loop::take_new_params() {
    quiesce_params_t params;
    if (exchange_.new_params.take(params)) {
        use_params(params);
        exchange_.wake();
    }
}

void Loop::after_restart() {
    if (node_.restarts == restarts_) {
        return;
    }
    restarts_ = node_.restarts;
    has_new_params_ = true;
    log_.log(LogLevel::info, "restarted with new parameters, hash %08x",
             static_cast<unsigned>(can_node_param_hash(&node_.params)));
    const auto rate_Hz = static_cast<std::uint32_t>(node_.params.tick_rate_Hz);
    if (rate_Hz != rate_Hz_) {
        rate_Hz_ = rate_Hz;
        source_.change_rate(rate_Hz);
    }
    if (has_adaptation_) {
        use_adaptation(adaptation_);
    }
}

void Loop::receive() {
    can_frame_t frame;
    for (int i = 0; bus_ != nullptr && i < kMaxReceived; ++i) {
        if (!can_bus_receive(bus_, &frame, nullptr)) {
            return;
        }
        node_receive(&node_, &frame);
    }
}

bool Loop::board_enable() {
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
    for (int i = 0; line != nullptr && i < kMaxReceived && gpio_next_edge(line, &edge); ++i) {
    }
    return level;
}

node_inputs_t Loop::board_inputs(std::uint32_t elapsed) {
    node_inputs_t inputs{};
    inputs.enable = board_enable();
    inputs.estop = estop_.is_pressed(devices_.estop_input, log_);
    inputs.driver_has_failed = !is_drivable();
    inputs.ticks_elapsed = elapsed;
    const hal_tick_t &timing = source_.timing();
    inputs.overruns = timing.overruns;
    inputs.lateness_us = timing.lateness_ns / 1000U;
    inputs.work_us = timing.work_ns / 1000U;
    if (bus_ != nullptr) {
        inputs.tx_dropped = can_bus_counters(bus_)->tx_dropped;
        inputs.bus_off_count = can_bus_counters(bus_)->bus_off;
    }
    return inputs;
}

bool Loop::is_safe_command() const {
    return node_.app.out.current_cmd_mA == quiesce_params_safe_current_mA(&node_.params) &&
           !node_.app.out.driver_enable;
}

/// The command has left with the demand frame, or, where the driver is at this machine, was written
/// in the control step.
void Loop::send(const can_frame_t *frames, std::uint32_t count) {
    const std::int64_t written_ns = is_written_ ? monotonic_ns() : 0;
    const std::int64_t demand_ns = send_frames(bus_, frames, count);
    const std::int64_t left_ns =
        config_.current.output == CurrentOutput::can ? demand_ns : written_ns;
    estop_.command_sent(left_ns != 0 && is_safe_command(), left_ns, node_.app.tick, log_);
}

/// Whether the driver takes its current: a CAN driver looks after itself.
bool Loop::is_drivable() {
    if (config_.current.output == CurrentOutput::can) {
        return true;
    }
    CurrentDevice *device = devices_.current.get();
    return device != nullptr && device->failures() == current_failures_;
}

void Loop::write_lines() {
    const bool rewrite = is_due_each_second();
    enable_output_.set(devices_.enable_output, node_.app.out.driver_enable && is_drivable(),
                       rewrite, log_);
    fault_output_.set(devices_.fault_output, node_.app.out.telemetry.fault != QUIESCE_FAULT_NONE,
                      rewrite, log_);
}

void Loop::look_after_accel() {
    if (config_.accel.source == AccelSource::can) {
        return;
    }
    if (devices_.accel.get() == nullptr) {
        silent_ticks_ = devices_.accel.pick_up() ? 0 : silent_ticks_;
    } else if (silent_ticks_ > rate_Hz_) {
        log_.log(LogLevel::error, "accelerometer: no sample for a second; it is opened anew");
        devices_.accel.give_up();
    }
}

void Loop::look_after_current() {
    CurrentDevice *device = devices_.current.get();
    if (device == nullptr) {
        if (devices_.current.pick_up()) {
            current_failures_ = 0;
        }
        return;
    }
    const std::uint32_t failures = device->failures();
    changes_.failed_writes(failures, monotonic_ns());
    if (is_due_each_second()) {
        if (failures != current_failures_) {
            log_.log(LogLevel::error, "current output: it is opened anew");
            devices_.current.give_up();
        }
        current_failures_ = failures;
    }
}

/// What it takes to get the bus back may wait: it is the other thread's.
void Loop::look_after_bus() {
    if (bus_ != nullptr && can_bus_maintain(bus_, monotonic_ns())) {
        exchange_.wake();
    }
}

void Loop::look_after_devices() {
    look_after_accel();
    look_after_current();
    (void)devices_.data_ready_input.pick_up();
    look_after_bus();
    feed_watchdogs(monotonic_ns());
}

/// Both say that the loop goes on; the disk, which the other thread may wait for, has no part in
/// it.
void Loop::feed_watchdogs(std::int64_t now_ns) {
    if (watchdog_ != nullptr) {
        watchdog_feed(watchdog_, now_ns);
    }
    const Notifier &manager = exchange_.manager;
    if (manager.watchdog_period_ns() > 0 && now_ns >= next_notice_ns_) {
        next_notice_ns_ = now_ns + manager.watchdog_period_ns();
        manager.send("WATCHDOG=1");
    }
}

Snapshot Loop::snapshot() const {
    Snapshot snapshot{};
    snapshot.telemetry = node_.app.out.telemetry;
    snapshot.is_driver_enabled = node_.app.out.driver_enable;
    snapshot.is_enabled = node_.app.in.enable;
    snapshot.is_estop = node_.app.in.estop;
    snapshot.kept_fault = latch_.held();
    snapshot.param_hash = can_node_param_hash(&node_.params);
    snapshot.timing = source_.timing();
    snapshot.ticks = exchange_.ticks.load();
    if (bus_ != nullptr) {
        snapshot.bus_state = can_bus_state(bus_);
        snapshot.bus = *can_bus_counters(bus_);
    }
    snapshot.node = *can_node_counters(&node_.can);
    snapshot.faults = changes_.faults();
    snapshot.fault_events = changes_.fault_events();
    snapshot.log_dropped = log_.dropped();
    return snapshot;
}

void Loop::put_snapshot() {
    if (exchange_.snapshot.put(snapshot())) {
        exchange_.wake();
    }
}

void Loop::put_adaptation() {
    keep_adaptation();
    if (has_adaptation_) {
        (void)exchange_.adaptation.put(adaptation_);
    }
}

void Loop::put_params() {
    if (has_new_params_ && exchange_.in_effect.put(node_.params)) {
        has_new_params_ = false;
        exchange_.wake();
    }
}

void Loop::report(std::int64_t now_ns) {
    changes_.control(node_.app.out.telemetry);
    changes_.overruns(source_.timing().overruns, now_ns);
    put_params();
    if (bus_ != nullptr) {
        changes_.bus(bus_);
    }
    if (exchange_.snapshot_is_wanted.exchange(false)) {
        put_snapshot();
    }
    if (is_due_each_second() && ++adaptation_age_s_ >= kAdaptationEvery_s) {
        adaptation_age_s_ = 0;
        put_adaptation();
    }
}

void Loop::tick(std::uint32_t elapsed) {
    take_new_params();
    receive();
    answer_store();
    prepare_apply();
    node_inputs_t inputs = board_inputs(elapsed);
    latch_.before_tick(inputs);
    can_frame_t frames[CAN_NODE_MAX_FRAMES];
    const std::uint32_t count = node_tick(&node_, &inputs, frames);
    send(frames, count);
    write_lines();
    latch_.after_tick(node_);
    after_restart();
    look_after_devices();
    report(monotonic_ns());
}

void Loop::run(std::uint64_t ticks) {
    rate_Hz_ = static_cast<std::uint32_t>(node_.params.tick_rate_Hz);
    restarts_ = node_.restarts;
    source_.start(rate_Hz_, config_.gpio.data_ready_input.has_value());
    std::uint64_t done = 0;
    while (!stop_is_requested() && (ticks == 0 || done < ticks)) {
        const std::uint32_t elapsed = source_.wait(devices_.data_ready_input, log_);
        if (elapsed == 0) {
            continue;
        }
        tick(elapsed);
        source_.done();
        exchange_.ticks.store(++done);
        if (done == 1) {
            exchange_.wake();
        }
    }
    leave();
}

/// No tick has to be kept any more: a full queue is waited for.
bool Loop::say_farewell(const can_frame_t &frame) {
    for (int i = 0; i < kFarewellPatience_ms; ++i) {
        if (can_bus_send(bus_, &frame)) {
            return true;
        }
        look_after_bus();
        sleep_ms(1);
    }
    return false;
}

void Loop::leave() {
    can_frame_t frame{};
    for (int i = 0; i < kFarewells; ++i) {
        node_leave(&node_, &frame);
        enable_output_.set(devices_.enable_output, false, true, log_);
        if (bus_ != nullptr && !say_farewell(frame)) {
            log_.log(LogLevel::error, "CAN: the farewell frame was not taken");
            break;
        }
        sleep_ms(kFarewellPause_ms);
    }
    fault_output_.set(devices_.fault_output, false, true, log_);
    log_.log(LogLevel::info, "safe current, output off; %llu ticks, %u lost",
             static_cast<unsigned long long>(exchange_.ticks.load()),
             static_cast<unsigned>(source_.timing().overruns));
    put_last();
}

/// The outputs are safe: there is time to wait for the other thread now.
void Loop::put_last() {
    keep_adaptation();
    bool is_put = !has_adaptation_;
    for (int i = 0; i < kLastAttempts && !is_put; ++i) {
        is_put = exchange_.adaptation.put(adaptation_);
        sleep_ms(is_put ? 0 : 1);
    }
    is_put = false;
    for (int i = 0; i < kLastAttempts && !is_put; ++i) {
        is_put = exchange_.snapshot.put(snapshot());
        sleep_ms(is_put ? 0 : 1);
    }
}

} // namespace quiesced
