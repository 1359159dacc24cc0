#include "status_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>

#include "clock.h"
#include "histogram.h"
#include "names.h"

namespace quiesced {

namespace {

const char *truth(bool value) {
    return value ? "true" : "false";
}

/// On the board; without one by its section.
const std::string &name_of(const Place &place) {
    return place.name.empty() ? place.section : place.name;
}

/// Names of boards need no escapes.
std::string quoted(const std::string &name) {
    return "\"" + name + "\"";
}

void put_control(std::ostream &out, const Snapshot &snapshot) {
    const quiesce_telemetry_t &t = snapshot.telemetry;
    out << "  \"tick\": " << t.tick << ",\n"
        << "  \"state\": \"" << state_name(t.state) << "\",\n"
        << "  \"fault\": \"" << fault_name(t.fault) << "\",\n"
        << "  \"kept_fault\": \"" << fault_name(snapshot.kept_fault) << "\",\n"
        << "  \"fault_count\": " << t.fault_count << ",\n"
        << "  \"is_enabled\": " << truth(snapshot.is_enabled) << ",\n"
        << "  \"is_estop\": " << truth(snapshot.is_estop) << ",\n"
        << "  \"is_driver_enabled\": " << truth(snapshot.is_driver_enabled) << ",\n"
        << "  \"current_cmd_mA\": " << t.current_cmd_mA << ",\n"
        << "  \"rms_um_s2\": " << t.rms_um_s2 << ",\n"
        << "  \"freq_is_valid\": " << truth(t.freq_is_valid != 0) << ",\n"
        << "  \"freq_uHz\": " << t.freq_uHz << ",\n"
        << "  \"displacement_amp_nm\": " << t.displacement_amp_nm << ",\n"
        << "  \"bad_sample_count\": " << t.bad_sample_count << ",\n"
        << "  \"param_hash\": " << snapshot.param_hash << ",\n";
}

void put_sensors(std::ostream &out, const Config &config, const Snapshot &snapshot) {
    out << "  \"sensors\": [";
    for (std::size_t i = 0; i < config.sensors.size(); ++i) {
        const SensorConfig &sensor = config.sensors[i];
        const quiesce_sample_t &sample = snapshot.sensors[i];
        out << (i == 0 ? "\n" : ",\n") << "    {\"name\": " << quoted(name_of(sensor.place))
            << ", \"source\": \"" << source_name(sensor.source)
            << "\", \"counts\": " << sample.counts << ", \"is_fresh\": " << truth(sample.is_fresh)
            << "}";
    }
    out << "\n  ],\n";
}

void put_dampers(std::ostream &out, const Config &config, const Snapshot &snapshot) {
    out << "  \"dampers\": [";
    for (std::size_t i = 0; i < config.outputs.size(); ++i) {
        const OutputConfig &output = config.outputs[i];
        const quiesce_driver_t &driver = snapshot.drivers[i];
        const quiesce_command_t &command = snapshot.commands[i];
        out << (i == 0 ? "\n" : ",\n") << "    {\"name\": " << quoted(name_of(output.place))
            << ", \"output\": \"" << output_name(output.output)
            << "\", \"current_cmd_mA\": " << command.current_cmd_mA
            << ", \"is_driver_enabled\": " << truth(command.driver_enable)
            << ", \"current_meas_mA\": ";
        if (driver.is_measured) {
            out << driver.current_mA;
        } else {
            out << "null";
        }
        out << ", \"has_failed\": " << truth(driver.has_failed) << "}";
    }
    out << "\n  ],\n";
}

std::string kind_json(const RoadStatus &road) {
    const char *kind = quiesce_table_kind(road.magic, nullptr);
    const char *name = road.magic == TABLE_FILE_LEARNT ? "learnt" : kind;
    return name != nullptr ? quoted(name) : "null";
}

void put_tables(std::ostream &out, const Snapshot &snapshot) {
    constexpr std::array<const char *, ROADS> names = {"law", "tracker", "learnt"};
    out << "  \"tables\": {";
    for (std::size_t i = 0; i < ROADS; ++i) {
        const RoadStatus &road = snapshot.roads[i];
        const bool is_refused = road.refusal != QUIESCE_TABLE_OK;
        out << (i == 0 ? "\n" : ",\n") << "    " << quoted(names[i])
            << ": {\"kind\": " << kind_json(road) << ", \"crc\": " << road.crc << ", \"source\": \""
            << table_source_name(road.source) << "\", \"stored_crc\": " << road.stored_crc
            << ", \"writes\": " << road.writes << ", \"record\": \""
            << record_state_name(road.record) << "\""
            << ", \"refusal\": " << (is_refused ? quoted(verdict_text(road.refusal)) : "null")
            << "}";
    }
    out << "\n  },\n";
}

void put_faults(std::ostream &out, const Snapshot &snapshot) {
    out << "  \"last_faults\": [";
    const char *separator = "";
    for (const FaultEvent &event : snapshot.faults) {
        if (event.fault == QUIESCE_FAULT_NONE) {
            break;
        }
        out << separator << "{\"fault\": \"" << fault_name(event.fault)
            << "\", \"tick\": " << event.tick << ", \"time\": \"" << iso_time(event.time_ns)
            << "\", \"times\": " << event.times << "}";
        separator = ", ";
    }
    out << "],\n";
}

std::string lost_json(const LossCounts &counts) {
    std::string out;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        out += (i == 0 ? "" : ", ") + quoted(loss_name(static_cast<LossCause>(i))) + ": " +
               std::to_string(counts[i]);
    }
    return "{" + out + "}";
}

void put_loop(std::ostream &out, const Snapshot &snapshot) {
    out << "  \"loop\": {\n"
        << "    \"ticks\": " << snapshot.ticks << ",\n"
        << "    \"overruns\": " << snapshot.timing.overruns << ",\n"
        << "    \"lost\": " << lost_json(snapshot.lost) << ",\n"
        << "    \"has_real_time_priority\": " << truth(snapshot.has_priority) << ",\n"
        << "    \"early_edges\": " << snapshot.timing.early << ",\n"
        << "    \"lateness\": " << histogram_json(snapshot.timing.lateness) << ",\n"
        << "    \"work\": " << histogram_json(snapshot.timing.work) << "\n  },\n";
}

void put_bus(std::ostream &out, const Snapshot &snapshot) {
    const can_bus_counters_t &bus = snapshot.bus;
    const can_node_counters_t &node = snapshot.node;
    out << "  \"can\": {\n"
        << "    \"state\": \"" << bus_state_name(snapshot.bus_state) << "\",\n"
        << "    \"received\": " << bus.received << ", \"sent\": " << bus.sent << ",\n"
        << "    \"tx_dropped\": " << bus.tx_dropped << ", \"tx_shed\": " << snapshot.tx_shed
        << ", \"rx_dropped\": " << bus.rx_dropped << ",\n"
        << "    \"error_frames\": " << bus.error_frames << ", \"malformed\": " << bus.malformed
        << ",\n"
        << "    \"bus_off\": " << bus.bus_off << ", \"restarts\": " << bus.restarts
        << ", \"down\": " << bus.down << ", \"overruns\": " << bus.overruns << ",\n"
        << "    \"accepted\": " << node.accepted << ", \"unknown\": " << node.unknown << ",\n"
        << "    \"rejected_crc\": " << node.rejected_crc
        << ", \"rejected_alive\": " << node.rejected_alive
        << ", \"rejected_shape\": " << node.rejected_shape << "\n  },\n";
}

} // namespace

std::string status_json(const Config &config, const Snapshot &snapshot) {
    std::ostringstream out;
    out << "{\n  \"version\": \"" << version() << "\",\n"
        << "  \"pid\": " << getpid() << ",\n"
        << "  \"time\": \"" << iso_time(realtime_ns()) << "\",\n";
    put_control(out, snapshot);
    put_sensors(out, config, snapshot);
    put_dampers(out, config, snapshot);
    put_tables(out, snapshot);
    put_faults(out, snapshot);
    put_loop(out, snapshot);
    put_bus(out, snapshot);
    out << "  \"log_dropped\": " << snapshot.log_dropped << "\n}\n";
    return out.str();
}

std::string replace_file(const std::string &file, const std::string &text) {
    const std::string aside = file + ".new";
    const int fd = open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (fd < 0) {
        return aside + ": " + std::strerror(errno);
    }
    const ssize_t written = write(fd, text.data(), text.size());
    const int why = written < 0 ? errno : ENOSPC;
    const bool is_whole = written == static_cast<ssize_t>(text.size());
    const bool is_closed = close(fd) == 0;
    if (is_whole && is_closed && std::rename(aside.c_str(), file.c_str()) == 0) {
        return "";
    }
    const int reason = is_whole ? errno : why;
    (void)unlink(aside.c_str());
    return file + ": " + std::strerror(reason);
}

} // namespace quiesced
