#include "run.h"

#include <cstdlib>
#include <memory>

#include <malloc.h>

#include "board_fit.h"
#include "caretaker.h"
#include "fault_store.h"
#include "input_error.h"
#include "instance_lock.h"
#include "kept_config.h"
#include "loop.h"
#include "names.h"
#include "read_config.h"
#include "service.h"
#include "signals.h"

namespace quiesced {

namespace {

constexpr std::size_t kHeapBytes = 4U << 20U;

/// The heap grows now, not later, and never shrinks: with locked memory no later use faults.
void prepare_heap() {
    mallopt(M_ARENA_MAX, 1);
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_MMAP_MAX, 0);
    std::free(std::malloc(kHeapBytes));
}

void open_lines(const GpioConfig &gpio, Peripherals &devices) {
    const auto output = [](const std::optional<LineConfig> &config, Replaceable<Line> &line,
                           const char *key) {
        if (config) {
            line.start_with(open_output(*config, key));
        }
    };
    const auto input = [](const std::optional<LineConfig> &config, Replaceable<Line> &line,
                          const char *key) {
        if (config) {
            line.start_with(open_input(*config, key));
        }
    };
    output(gpio.enable_output, devices.enable_output, "gpio.enable_output");
    output(gpio.fault_output, devices.fault_output, "gpio.fault_output");
    input(gpio.estop_input, devices.estop_input, "gpio.estop_input");
    if (gpio.enable_input) {
        devices.enable_input.start_with(open_enable(*gpio.enable_input, "gpio.enable_input"));
    }
    input(gpio.data_ready_input, devices.data_ready_input, "gpio.data_ready_input");
}

void open_peripherals(const Config &config, Peripherals &devices) {
    refuse_shared_outputs(config);
    for (std::size_t i = 0; i < config.outputs.size(); ++i) {
        devices.outputs[i].start_with(open_current(config.outputs[i], config.folders));
    }
    open_lines(config.gpio, devices);
    for (std::size_t i = 0; i < config.sensors.size(); ++i) {
        devices.sensors[i].start_with(open_sensor(config.sensors[i], config.folders));
    }
}

void become_realtime(const LoopConfig &loop) {
    const tick_thread_options_t options = {loop.priority, loop.cpu, loop.lock_memory};
    linux_error_t error{};
    if (!tick_linux_thread(&options, &error)) {
        throw quiesce::InputError(std::string("loop: ") + error.text);
    }
}

void log_start(const Config &config, const quiesce_params_t &params, LogRing &log) {
    log.log(LogLevel::info, "quiesced %s, %s, %s, parameter hash %08x, %s", version(),
            config.file.c_str(), gpio_library(),
            static_cast<unsigned>(can_node_param_hash(&params)),
            config.can ? config.can->interface.c_str() : "no CAN");
}

void log_scheduling(const LoopConfig &loop, LogRing &log) {
    if (loop.priority == 0) {
        log.log(LogLevel::warning,
                "no real-time priority (loop.priority is 0): a busy machine loses "
                "ticks, each ends in the safe current");
    }
}

void log_note(const std::string &note, LogRing &log) {
    if (!note.empty()) {
        log.log(LogLevel::warning, "%s", note.c_str());
    }
}

/// Before anything is switched on.
void keep_config(const ReadConfig &read, const quiesce_params_t &params, LogRing &log) {
    KeptConfig kept(read.config.state.folder);
    const std::string error = kept.keep(read.text, read.board_text, params);
    if (!error.empty()) {
        log_note("--make-safe will have to use the configuration's file as it is then: " + error,
                 log);
    }
}

/// A controller that could not keep a fault does not start.
std::uint32_t start_faults(FaultStore &faults, std::string &note) {
    const std::uint32_t fault = faults.load(note);
    if (const std::string error = faults.keep(fault); !error.empty()) {
        throw quiesce::InputError("state.folder: a fault could not be kept: " + error +
                                  "; make room there, or give the right to write");
    }
    return fault;
}

/// A record that cannot be kept is no reason not to control.
KeptRecord start_records(RecordStore &records, std::string &note) {
    const KeptRecord record = records.load(note);
    if (const std::string error = records.keep(record); !error.empty()) {
        note += (note.empty() ? "" : "; ") + ("a fault record could not be kept: " + error);
    }
    return record;
}

void use_record(Loop &loop, const KeptRecord &record, LogRing &log) {
    if (!loop.use_record(record)) {
        log.log(LogLevel::warning, "the fault record is not used: another version's");
    } else if (record.is_held != 0) {
        log.log(LogLevel::info,
                "the fault record of an earlier run can be read: quiesce can freeze");
    }
}

void log_kept_fault(const std::string &note, LogRing &log) {
    if (!note.empty()) {
        log.log(LogLevel::error,
                "%s: safe current, driver off until then (OperatorCommand, or --clear-fault)",
                note.c_str());
    }
}

} // namespace

int run_controller(const std::string &config_file, std::uint64_t ticks) {
    const ReadConfig read = require_config_text(config_file);
    const Config &config = read.config;
    install_signals();
    const InstanceLock lock(config.state.folder);
    prepare_heap();
    LogSink sink(config.log);
    const auto exchange = std::make_unique<Exchange>();
    const StateStore store(config.state.folder);
    std::string params_note;
    const quiesce_params_t params = start_params(config, store, params_note);
    const StartTables tables = find_tables(config);
    std::string fault_note;
    FaultStore faults(config.state.folder);
    exchange->latched_fault.store(start_faults(faults, fault_note));

    std::string record_note;
    RecordStore records(config.state.folder);
    const KeptRecord record = start_records(records, record_note);

    Caretaker caretaker(config.file, config.state.folder, exchange->latched_fault);
    open_peripherals(config, exchange->peripherals);
    const Bus bus = config.can ? open_bus(*config.can, BusUse::controller) : nullptr;
    keep_config(read, params, exchange->log);
    exchange->bus = bus.get();
    const Service service(config, tables.configured, *exchange, {faults, records, caretaker}, sink);
    become_realtime(config.loop);
    // Last, because it cannot always be stopped again.
    const Watchdog watchdog = config.watchdog ? open_watchdog(*config.watchdog) : nullptr;
    TickSource source;
    const auto loop =
        std::make_unique<Loop>(config, params, *exchange, source, bus.get(), watchdog.get());
    log_start(config, params, exchange->log);
    log_scheduling(config.loop, exchange->log);
    log_note(params_note, exchange->log);
    for (const std::string &note : tables.notes) {
        log_note(note, exchange->log);
    }
    log_kept_fault(fault_note, exchange->log);
    log_note(record_note, exchange->log);
    use_record(*loop, record, exchange->log);
    loop->use_tables(tables);
    loop->run(ticks);
    return 0;
}

} // namespace quiesced
