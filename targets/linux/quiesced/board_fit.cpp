#include "board_fit.h"

#include <cstdio>
#include <cstring>

namespace quiesced {

namespace {

std::uint32_t index_of(const char *name) {
    std::uint32_t index = 0;
    while (std::strcmp(quiesce_param_info(index)->name, name) != 0) {
        ++index;
    }
    return index;
}

Misfit make_misfit(const char *name, const char *section, const char *key) {
    return {index_of(name), section, key, {}};
}

/// The sensor's edges are the ticks: its rate is set once, at the opening.
bool has_other_rate(const Config &config, const quiesce_params_t &params) {
    return config.accel.source == AccelSource::adxl355 && config.gpio.data_ready_input &&
           params.tick_rate_Hz != static_cast<std::int32_t>(config.accel.rate_Hz);
}

bool is_beyond_output(const Config &config, const quiesce_params_t &params) {
    return config.current.output != CurrentOutput::can &&
           params.max_current_mA > config.current.full_scale_mA;
}

} // namespace

std::optional<Misfit> find_misfit(const Config &config, const quiesce_params_t &params) {
    if (has_other_rate(config, params)) {
        Misfit out = make_misfit("tick_rate_Hz", "accel", "rate_Hz");
        (void)std::snprintf(out.reason.data(), out.reason.size(),
                            "accel.rate_Hz is %u, tick_rate_Hz %d; they must be the same where "
                            "data_ready_input starts the ticks",
                            static_cast<unsigned>(config.accel.rate_Hz),
                            static_cast<int>(params.tick_rate_Hz));
        return out;
    }
    if (is_beyond_output(config, params)) {
        Misfit out = make_misfit("max_current_mA", "current", "full_scale_mA");
        (void)std::snprintf(out.reason.data(), out.reason.size(),
                            "current.full_scale_mA is %d, max_current_mA %d; it must not be more "
                            "than the output can give",
                            static_cast<int>(config.current.full_scale_mA),
                            static_cast<int>(params.max_current_mA));
        return out;
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
