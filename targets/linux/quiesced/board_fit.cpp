#include "board_fit.h"

#include <cstdio>
#include <cstring>

#include "bus_load.h"

namespace quiesced {

namespace {

std::uint32_t index_of(const char *name) {
    std::uint32_t index = 0;
    while (std::strcmp(quiesce_param_info(index)->name, name) != 0) {
        ++index;
    }
    return index;
}

/// table: of those of the section.
Misfit make_misfit(const char *parameter, const char *section, std::size_t table, const char *key) {
    return {index_of(parameter), section, table, key, {}};
}

/// The sensor's edges are the ticks: its rate is set once, at the opening.
std::optional<Misfit> find_other_rate(const Config &config, const quiesce_params_t &params) {
    for (const SensorConfig &sensor : config.sensors) {
        if (sensor.source == SensorSource::adxl355 && config.gpio.data_ready_input &&
            params.tick_rate_Hz != static_cast<std::int32_t>(sensor.rate_Hz)) {
            const char *section = sensor.place.section.c_str();
            Misfit out = make_misfit("tick_rate_Hz", section, sensor.place.table, "rate_Hz");
            (void)std::snprintf(out.reason.data(), out.reason.size(),
                                "%s.rate_Hz is %u, tick_rate_Hz %d; they must be the same where "
                                "data_ready_input starts the ticks",
                                section, static_cast<unsigned>(sensor.rate_Hz),
                                static_cast<int>(params.tick_rate_Hz));
            return out;
        }
    }
    return std::nullopt;
}

/// With a board its ceilings are within the outputs, and no command is above them.
std::optional<Misfit> find_beyond_output(const Config &config, const quiesce_params_t &params) {
    const OutputConfig &output = config.outputs.front();
    if (config.board || output.output == CurrentOutput::can ||
        params.max_current_mA <= output.full_scale_mA) {
        return std::nullopt;
    }
    Misfit out = make_misfit("max_current_mA", "current", 0, "full_scale_mA");
    (void)std::snprintf(out.reason.data(), out.reason.size(),
                        "current.full_scale_mA is %d, max_current_mA %d; it must not be more than "
                        "the output can give",
                        static_cast<int>(output.full_scale_mA),
                        static_cast<int>(params.max_current_mA));
    return out;
}

std::optional<Misfit> find_missing_signal(const Config &config, const quiesce_params_t &params) {
    const auto law = static_cast<std::size_t>(params.law);
    const auto tracker = static_cast<std::size_t>(params.tracker);
    if (!config.board || law >= config.board->missing.size() ||
        tracker >= config.board->missing[law].size() ||
        config.board->missing[law][tracker].empty()) {
        return std::nullopt;
    }
    Misfit out = make_misfit("law", "board", 0, "file");
    (void)std::snprintf(out.reason.data(), out.reason.size(),
                        "law %s needs signal %s, which no sensor of the board provides",
                        quiesce_param_info(out.index)->labels[law],
                        config.board->missing[law][tracker].c_str());
    return out;
}

std::optional<Misfit> find_full_bus(const Config &config, const quiesce_params_t &params) {
    if (!config.can) {
        return std::nullopt;
    }
    const BusLoad load = bus_load(config, params);
    if (load.total() <= kMostLoad_pct) {
        return std::nullopt;
    }
    const std::uint32_t bitrate = config.can->bitrate;
    Misfit out = make_misfit("tick_rate_Hz", "can", 0, "interface");
    (void)std::snprintf(
        out.reason.data(), out.reason.size(),
        "the bus would be %.1f %% full at %u bit/s (demands %.1f, samples %.1f, others %.1f), more "
        "than %.0f: a lower tick_rate_Hz, sensors at this machine or CAN FD (fd, data_bitrate) "
        "would help",
        load.total(), static_cast<unsigned>(bitrate != 0 ? bitrate : kUsualBitrate), load.demands,
        load.samples, load.others, kMostLoad_pct);
    return out;
}

} // namespace

std::optional<Misfit> find_misfit(const Config &config, const quiesce_params_t &params) {
    for (const auto find :
         {find_other_rate, find_beyond_output, find_missing_signal, find_full_bus}) {
        if (std::optional<Misfit> misfit = find(config, params)) {
            return misfit;
        }
    }
    return std::nullopt;
}

quiesce_params_t start_params(const Config &config, const StateStore &store, std::string &note) {
    const quiesce_params_t params = store.effective(config.params, note);
    const std::optional<Misfit> misfit = find_misfit(config, params);
    if (!misfit) {
        return params;
    }
    note = std::string("saved parameters are not used: ") + misfit->reason.data();
    return config.params;
}

} // namespace quiesced
