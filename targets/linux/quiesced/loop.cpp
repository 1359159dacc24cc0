#include "loop.h"

#include <algorithm>
#include <iterator>

#include "board_fit.h"
#include "clock.h"
#include "frame_sender.h"
#include "names.h"
#include "signals.h"

namespace quiesced {

namespace {

constexpr int kMaxReceived = 64; // frames a tick; the rest waits for the next one
constexpr int kFarewells = 3;    // one might be lost
constexpr int kFarewellPause_ms = 2;
constexpr int kFarewellPatience_ms = 200; // well below the least timeout of a watchdog
constexpr int kLastAttempts = 1000;       // a millisecond apart

} // namespace

Loop::Loop(const Config &config, const quiesce_params_t &params, Exchange &exchange,
           TickSource &source, can_bus_t *bus, watchdog_t *watchdog)
    : config_(config), exchange_(exchange), log_(exchange.log), bus_(bus), tables_(node_, exchange),
      latch_(exchange), board_(config, exchange, bus, watchdog), source_(source),
      changes_(exchange.log) {
    use_axes(
        node_init(&node_, config.wiring(), &params, {config.enable_from, config.sensors_on_bus()}));
    if (config.wiring() == nullptr) {
        node_.most_mA = config.params.max_current_mA;
    }
    write_commands();
    tables_.connect();
}

/// As the board says, or the parameters, unless they are refused.
void Loop::use_axes(bool is_accepted) {
    const quiesce_board_t *wiring = config_.wiring();
    axes_.fill(HAL_AXIS_Z);
    if (wiring == nullptr && is_accepted) {
        axes_[0] = static_cast<hal_axis_t>(node_.params.accel_axis);
    }
    for (std::size_t i = 0; wiring != nullptr && i < config_.sensors.size(); ++i) {
        axes_[i] = static_cast<hal_axis_t>(wiring->sensor[i].axis);
    }
}

/// A fault of an earlier run keeps the driver off, whatever the core says.
void Loop::write_current(std::size_t damper, std::int32_t current_mA, bool enable) {
    board_.write_current(damper, current_mA, enable && !latch_.is_holding());
}

void Loop::write_commands() {
    for (std::uint32_t i = 0; i < node_dampers(&node_); ++i) {
        write_current(i, node_.out.damper[i].current_cmd_mA, node_.out.damper[i].driver_enable);
    }
}

void Loop::write_safe(const quiesce_params_t &params) {
    for (std::uint32_t i = 0; i < node_dampers(&node_); ++i) {
        write_current(i, safe_current_mA(node_.board, &params, i), false);
    }
}

/// The drivers are off while the controller starts.
void Loop::restart(const quiesce_params_t &params) {
    write_safe(params);
    node_restart(&node_, &params);
    use_axes(true);
    write_commands();
}

bool Loop::use_record(const KeptRecord &record) {
    return record.is_held == 0 ||
           fault_record_load(&node_.can.record, record.words.data(), record.is_acknowledged != 0);
}

/// What the node does not know: what the board can do.
void Loop::prepare_apply() {
    if (can_node_task(&node_.can) != CAN_NODE_APPLY) {
        return;
    }
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
    if (!quiesce_params_check(&params, &error)) {
        log_.log(LogLevel::error, "parameters stay: %s: %s", quiesce_param_info(error.index)->name,
                 error.reason);
    } else if (quiesce_is_armed(&node_.controller)) {
        use_live(params);
    } else {
        node_.most_mA =
            std::max(node_.most_mA, params.max_current_mA); // who may raise it: the file
        restart(params);
    }
}

void Loop::use_live(const quiesce_params_t &params) {
    std::uint32_t index = 0;
    if (quiesce_params_differ_live(&node_.params, &params, &index)) {
        (void)node_retune(&node_, &params);
    } else {
        log_.log(LogLevel::error,
                 "parameters stay: %s may not change while the controller is armed; disarm first",
                 quiesce_param_info(index)->name);
    }
}

void Loop::take_new_params() {
    quiesce_params_t params;
    if (exchange_.new_params.take(params)) {
        use_params(params);
        exchange_.wake();
    }
}

void Loop::after_change() {
    if (node_.retunes != retunes_) {
        retunes_ = node_.retunes;
        has_new_params_ = true;
        log_.log(LogLevel::info, "other live parameters, hash %08x",
                 static_cast<unsigned>(can_node_param_hash(&node_.params)));
    }
    if (node_.restarts != restarts_) {
        after_restart();
    }
}

void Loop::after_restart() {
    restarts_ = node_.restarts;
    has_new_params_ = true;
    log_.log(LogLevel::info, "restarted with new parameters, hash %08x",
             static_cast<unsigned>(can_node_param_hash(&node_.params)));
    const auto rate_Hz = static_cast<std::uint32_t>(node_.params.tick_rate_Hz);
    if (rate_Hz != rate_Hz_) {
        rate_Hz_ = rate_Hz;
        source_.change_rate(rate_Hz);
        board_.use_rate(rate_Hz);
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

bool Loop::is_safe_command() const {
    bool are_all = true;
    for (std::uint32_t i = 0; i < node_dampers(&node_); ++i) {
        const quiesce_command_t &command = node_.out.damper[i];
        are_all = are_all && command.current_cmd_mA == node_.safe_mA[i] && !command.driver_enable;
    }
    return are_all;
}

void Loop::send() {
    can_frame_t frames[NODE_MAX_FRAMES];
    const std::uint32_t count = node_frames(&node_, frames);
    std::int64_t demand_ns = 0;
    if (bus_ != nullptr) {
        const auto sink = [](void *bus, const can_frame_t *frame) {
            return can_bus_send(static_cast<can_bus_t *>(bus), frame);
        };
        demand_ns = sender_.send(sink, bus_, frames, count, monotonic_ns());
    }
    board_.command_left(demand_ns, is_safe_command(), node_.in.tick);
}

Snapshot Loop::snapshot() const {
    Snapshot snapshot{};
    snapshot.telemetry = node_.out.telemetry;
    std::copy(std::begin(node_.in.sensor), std::end(node_.in.sensor), snapshot.sensors.begin());
    std::copy(std::begin(node_.in.driver), std::end(node_.in.driver), snapshot.drivers.begin());
    std::copy(std::begin(node_.out.damper), std::end(node_.out.damper), snapshot.commands.begin());
    snapshot.is_driver_enabled = node_.out.damper[0].driver_enable;
    snapshot.is_enabled = node_.in.enable;
    snapshot.is_estop = node_.in.estop;
    snapshot.kept_fault = latch_.held();
    snapshot.param_hash = can_node_param_hash(&node_.params);
    snapshot.timing = source_.timing();
    snapshot.lost = lost_.counts();
    snapshot.has_priority = this_thread().is_realtime;
    snapshot.ticks = exchange_.ticks.load();
    if (bus_ != nullptr) {
        snapshot.bus_state = can_bus_state(bus_);
        snapshot.bus = *can_bus_counters(bus_);
        const can_unsent_t &unsent = sender_.counters().unsent;
        snapshot.tx_shed = unsent.demands + unsent.telemetry;
        snapshot.bus.tx_dropped = unsent.answers + snapshot.tx_shed;
    }
    snapshot.node = *can_node_counters(&node_.can);
    snapshot.roads = tables_.status();
    snapshot.faults = changes_.faults();
    snapshot.log_dropped = log_.dropped();
    return snapshot;
}

void Loop::put_snapshot() {
    if (exchange_.snapshot.put(snapshot())) {
        exchange_.wake();
    }
}

/// Returns false iff the other thread has not taken the last one yet.
bool Loop::put_record() {
    const fault_record_t &record = node_.can.record;
    if (record.generation == record_generation_) {
        return true;
    }
    KeptRecord kept{};
    kept.is_held = fault_record_copy(&record, kept.words.data()) ? 1 : 0;
    kept.is_acknowledged = record.is_acknowledged ? 1 : 0;
    if (!exchange_.record.put(kept)) {
        return false;
    }
    record_generation_ = record.generation;
    exchange_.wake();
    return true;
}

void Loop::put_params() {
    if (has_new_params_ && exchange_.in_effect.put(node_.params)) {
        has_new_params_ = false;
        exchange_.wake();
    }
}

void Loop::report(std::int64_t now_ns) {
    changes_.control(node_.out.telemetry);
    changes_.overruns(source_.timing().overruns, lost_.last(), now_ns);
    put_params();
    (void)put_record();
    tables_.tell();
    if (bus_ != nullptr) {
        changes_.bus(bus_);
    }
    if (exchange_.snapshot_is_wanted.exchange(false)) {
        put_snapshot();
    }
}

void Loop::count_lost(std::uint32_t elapsed) {
    if (elapsed > 1) {
        lost_.count(elapsed - 1, source_.timing(), config_.gpio.data_ready_input.has_value(),
                    this_thread());
    }
}

void Loop::tick(std::uint32_t elapsed) {
    count_lost(elapsed);
    take_new_params();
    receive();
    tables_.take();
    prepare_apply();
    node_inputs_t inputs = board_.read(axes_, elapsed, source_.timing());
    inputs.unsent = sender_.counters().unsent;
    latch_.before_tick(inputs);
    node_step(&node_, &inputs);
    latch_.keep_new(node_);
    write_commands();
    if (const quiesce_params_t *params = node_task(&node_)) {
        restart(*params);
    }
    send();
    board_.write_lines(node_.out.damper[0].driver_enable,
                       node_.out.telemetry.fault != QUIESCE_FAULT_NONE, is_refresh_due());
    latch_.after_tick(node_);
    after_change();
    board_.look_after(rate_Hz_, is_due_each_second(), changes_);
    report(monotonic_ns());
}

void Loop::run(std::uint64_t ticks) {
    rate_Hz_ = static_cast<std::uint32_t>(node_.params.tick_rate_Hz);
    restarts_ = node_.restarts;
    retunes_ = node_.retunes;
    board_.use_rate(rate_Hz_);
    source_.start(rate_Hz_, config_.gpio.data_ready_input.has_value());
    std::uint64_t done = 0;
    while (!stop_is_requested() && (ticks == 0 || done < ticks)) {
        const std::uint32_t elapsed = source_.wait(exchange_.peripherals.data_ready_input, log_);
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
bool Loop::say_farewell() {
    can_frame_t frames[QUIESCE_DAMPERS];
    const std::uint32_t count = node_farewell(&node_, frames);
    std::uint32_t sent = 0;
    for (int i = 0; i < kFarewellPatience_ms && bus_ != nullptr; ++i) {
        while (sent < count && can_bus_send(bus_, &frames[sent])) {
            ++sent;
        }
        if (sent == count) {
            return true;
        }
        board_.look_after_bus();
        sleep_ms(1);
    }
    return bus_ == nullptr;
}

void Loop::leave() {
    for (int i = 0; i < kFarewells; ++i) {
        write_safe(node_.params);
        board_.release_enable_line();
        if (!say_farewell()) {
            log_.log(LogLevel::error, "CAN: the farewell frame was not taken");
            break;
        }
        sleep_ms(kFarewellPause_ms);
    }
    board_.release_fault_line();
    log_.log(LogLevel::info, "safe current, output off; %llu ticks, %u lost",
             static_cast<unsigned long long>(exchange_.ticks.load()),
             static_cast<unsigned>(source_.timing().overruns));
    put_last();
}

/// The outputs are safe: there is time to wait for the other thread now.
void Loop::put_last() {
    fault_record_finish(&node_.can.record);
    for (int i = 0; i < kLastAttempts && !put_record(); ++i) {
        sleep_ms(1);
    }
    tables_.store_last();
    bool is_put = false;
    for (int i = 0; i < kLastAttempts && !is_put; ++i) {
        is_put = exchange_.snapshot.put(snapshot());
        sleep_ms(is_put ? 0 : 1);
    }
}

} // namespace quiesced
