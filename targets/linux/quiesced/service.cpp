#include "service.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include <poll.h>
#include <unistd.h>

#include "board_fit.h"
#include "clock.h"
#include "histogram.h"
#include "input_error.h"
#include "names.h"
#include "read_config.h"
#include "signals.h"
#include "status_file.h"

namespace quiesced {

namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr int kLongestWait_ms = 100;

std::string status_line(const Snapshot &snapshot) {
    const quiesce_telemetry_t &t = snapshot.telemetry;
    std::array<char, 160> text{};
    (void)std::snprintf(text.data(), text.size(), "%s, fault %s, %d mA, %.2f Hz, %u ticks lost",
                        state_name(t.state), fault_name(t.fault),
                        static_cast<int>(t.current_cmd_mA),
                        t.freq_is_valid != 0 ? t.freq_uHz / 1e6 : 0.0,
                        static_cast<unsigned>(snapshot.timing.overruns));
    return text.data();
}

} // namespace

void Trouble::note(const std::string &error, LogSink &sink) {
    if (!error.empty() && failures_++ == 0) {
        sink.write(LogLevel::error, std::string(name_) + ": not written: " + error);
    } else if (error.empty() && failures_ > 0) {
        sink.write(LogLevel::warning, std::string(name_) + ": written again after " +
                                          std::to_string(failures_) + " failures");
        failures_ = 0;
    }
}

Service::Service(const Config &config, const ConfiguredTables &tables, Exchange &exchange,
                 const Survivors &survivors, LogSink &sink)
    : config_(config), exchange_(exchange), sink_(sink), store_(config.state.folder),
      tables_(config.state.folder), faults_(survivors.faults), records_(survivors.records),
      caretaker_(survivors.caretaker), kept_(config.state.folder), manager_(exchange.manager),
      reload_(config, store_, tables, exchange, sink), stored_fault_(exchange.latched_fault.load()),
      thread_([this] { run(); }) {}

Service::~Service() {
    exchange_.loop_has_ended.store(true);
    exchange_.wake();
    thread_.join();
}

void Service::run() {
    take_signals(exchange_.wake_fd);
    while (!exchange_.loop_has_ended.load()) {
        wait();
        work(monotonic_ns());
    }
    take_signals(-1);
    say_last_words();
}

void Service::wait() {
    pollfd ready = {exchange_.wake_fd, POLLIN, 0};
    if (poll(&ready, 1, kLongestWait_ms) == 1) {
        std::uint64_t count = 0;
        const ssize_t ignored = read(exchange_.wake_fd, &count, sizeof count);
        (void)ignored;
    }
}

void Service::work(std::int64_t now_ns) {
    store_fault(now_ns); // first: the program may be killed at any time
    store_record(now_ns);
    drain_log();
    if (exchange_.bus != nullptr) {
        can_bus_recover(exchange_.bus);
    }
    keep_params();
    store_words();
    if (take_reload_request()) {
        reload_.begin();
    }
    reload_.finish();
    if (take_status_request() || now_ns >= next_status_ns_) {
        next_status_ns_ = now_ns + config_.state.status_s * kSecond_ns;
        exchange_.snapshot_is_wanted.store(true);
    }
    write_files();
    if (now_ns >= next_devices_ns_) {
        next_devices_ns_ = now_ns + kSecond_ns;
        look_after_devices();
        if (caretaker_.has_ended()) {
            sink_.write(LogLevel::error, "the caretaker has ended: nothing but --make-safe helps "
                                         "where this process is killed");
        }
    }
    tell_manager();
}

void Service::drain_log() {
    LogLine line{};
    while (exchange_.log.take(line)) {
        sink_.write(line);
    }
    const std::uint32_t dropped = exchange_.log.dropped();
    if (dropped != told_dropped_) {
        sink_.write(LogLevel::warning, std::to_string(dropped - told_dropped_) +
                                           " log lines dropped: too many at once");
        told_dropped_ = dropped;
    }
}

std::string Service::store(const StoreOrder &order) {
    const Words &of = order.of;
    if (order.record == KEEPER_PARAMS) {
        quiesce_params_t params{};
        std::memcpy(&params, of.words.data(), sizeof params);
        return store_.save_params(reload_.params(), params);
    }
    const std::uint32_t road = road_of(order.record);
    const std::uint32_t configured =
        road < QUIESCE_TABLE_OWNERS ? crc_of(reload_.tables()[road]) : 0;
    return tables_.save(order.record, {configured, table_file_board(config_.wiring())},
                        of.words.data(), of.count);
}

void Service::store_words() {
    const StoreOrder *order = exchange_.to_store.look();
    if (order == nullptr) {
        return;
    }
    const std::string error = store(*order);
    const char *what =
        order->record == KEEPER_PARAMS ? "parameters" : road_name(road_of(order->record));
    const char *done = order->of.count == 0 ? "forgotten: " : "saved: ";
    exchange_.to_store.drop();
    sink_.write(error.empty() ? LogLevel::info : LogLevel::error,
                error.empty() ? done + std::string(what)
                              : std::string("not saved: ") + what + ": " + error);
    exchange_.store_result.store(error.empty() ? StoreResult::stored : StoreResult::failed);
}

void Service::store_fault(std::int64_t now_ns) {
    const std::uint32_t fault = exchange_.latched_fault.load();
    if (fault == stored_fault_ || now_ns < next_fault_ns_) {
        return;
    }
    const std::string error = faults_.keep(fault);
    fault_trouble_.note(error, sink_);
    if (!error.empty()) {
        next_fault_ns_ = now_ns + kSecond_ns;
        return;
    }
    stored_fault_ = fault;
    sink_.write(LogLevel::info, fault == QUIESCE_FAULT_NONE
                                    ? "the kept fault is forgotten"
                                    : std::string("fault ") + fault_name(fault) +
                                          " is kept until it is acknowledged");
}

void Service::store_record(std::int64_t now_ns) {
    KeptRecord record{};
    if (exchange_.record.take(record)) {
        record_ = record;
    }
    if (!record_ || now_ns < next_record_ns_) {
        return;
    }
    const std::string error = records_.keep(*record_);
    record_trouble_.note(error, sink_);
    if (!error.empty()) {
        next_record_ns_ = now_ns + kSecond_ns;
        return;
    }
    sink_.write(LogLevel::info, record_->is_held != 0 ? "the fault record is kept"
                                                      : "the kept fault record is forgotten");
    record_.reset();
}

/// What --make-safe has to use.
void Service::keep_params() {
    quiesce_params_t params;
    if (exchange_.in_effect.take(params)) {
        const std::string error = kept_.keep_params(params);
        params_trouble_.note(error, sink_);
        if (error.empty()) {
            sink_.write(LogLevel::debug, "parameters for --make-safe are kept");
        }
    }
}

void Service::write_files() {
    if (exchange_.snapshot.take(last_)) {
        status_trouble_.note(replace_file(store_.status_file(), status_json(config_, last_)),
                             sink_);
        manager_.send("STATUS=" + status_line(last_));
    }
}

void Service::look_after_devices() {
    const GpioConfig &gpio = config_.gpio;
    Peripherals &devices = exchange_.peripherals;
    const auto say = [this](const std::string &line) {
        if (!line.empty()) {
            sink_.write(LogLevel::warning, line);
        }
    };
    for (std::size_t i = 0; i < config_.sensors.size(); ++i) {
        const SensorConfig &sensor = config_.sensors[i];
        say(devices.sensors[i].maintain(sensor.place.title.c_str(),
                                        [&] { return open_sensor(sensor, config_.folders); }));
    }
    for (std::size_t i = 0; i < config_.outputs.size(); ++i) {
        const OutputConfig &output = config_.outputs[i];
        say(devices.outputs[i].maintain(output.place.title.c_str(),
                                        [&] { return open_current(output, config_.folders); }));
    }
    const auto output = [&](Replaceable<Line> &line, const std::optional<LineConfig> &config,
                            const char *name) {
        say(line.maintain(name, [&] { return open_output(*config, name); }));
    };
    const auto input = [&](Replaceable<Line> &line, const std::optional<LineConfig> &config,
                           const char *name) {
        say(line.maintain(name, [&] { return open_input(*config, name); }));
    };
    output(devices.enable_output, gpio.enable_output, "enable_output");
    output(devices.fault_output, gpio.fault_output, "fault_output");
    input(devices.estop_input, gpio.estop_input, "estop_input");
    say(devices.enable_input.maintain(
        "enable_input", [&] { return open_enable(*gpio.enable_input, "enable_input"); }));
    input(devices.data_ready_input, gpio.data_ready_input, "data_ready_input");
}

void Service::tell_manager() {
    if (!is_ready_ && exchange_.ticks.load() > 0) {
        is_ready_ = true;
        manager_.send("READY=1\nMAINPID=" + std::to_string(getpid()));
    }
    if (!is_stopping_ && stop_is_requested()) {
        is_stopping_ = true;
        manager_.send("STOPPING=1");
    }
}

void Service::say_last_words() {
    manager_.send("STOPPING=1");
    next_fault_ns_ = 0;
    next_record_ns_ = 0;
    store_fault(monotonic_ns());
    store_record(monotonic_ns());
    drain_log();
    store_words();
    keep_params();
    write_files();
    if (last_.ticks > 0) {
        sink_.write(LogLevel::info, "lateness: " + histogram_line(last_.timing.lateness));
        sink_.write(LogLevel::info, "work: " + histogram_line(last_.timing.work));
    }
    if (sink_.lost() > 0) {
        sink_.write(LogLevel::warning,
                    std::to_string(sink_.lost()) + " log lines could not be written");
    }
}

} // namespace quiesced
