#include "param_options.h"

#include <cmath>
#include <limits>
#include <optional>

#include "arguments.h"
#include "input_error.h"

namespace quiesce {

namespace {

std::uint32_t index_of(const std::string &name) {
    for (std::uint32_t index = 0; index < QUIESCE_PARAM_COUNT; ++index) {
        if (name == quiesce_param_info(index)->name) {
            return index;
        }
    }
    throw InputError("--set " + name +
                     ": unknown parameter; 'quiesce_bench params' lists the known ones");
}

std::string labels_of(const quiesce_param_info_t &info) {
    std::string labels;
    for (std::int32_t i = 0; info.labels != nullptr && i <= info.max; ++i) {
        labels += std::string(labels.empty() ? "" : ", ") + info.labels[i];
    }
    return labels;
}

std::optional<std::int32_t> parse_value(const quiesce_param_info_t &info, const std::string &text) {
    for (std::int32_t i = 0; info.labels != nullptr && i <= info.max; ++i) {
        if (text == info.labels[i]) {
            return i;
        }
    }
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value || *value < std::numeric_limits<std::int32_t>::min() ||
        *value > std::numeric_limits<std::int32_t>::max()) {
        return std::nullopt;
    }
    return static_cast<std::int32_t>(*value);
}

} // namespace

void fit_to_sensor(quiesce_params_t &params, const AccelerometerParams &sensor) {
    const Accelerometer accelerometer(sensor, 0);
    params.accel_scale_nm_s2 =
        static_cast<std::int32_t>(std::lround(1e9 * accelerometer.scale_m_s2()));
    params.accel_full_scale_counts = accelerometer.full_scale_counts();
}

void set_param(quiesce_params_t &params, const std::string &assignment) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) {
        throw InputError("--set " + assignment + ": expected NAME=VALUE");
    }
    const std::string name = assignment.substr(0, equals);
    const std::string text = assignment.substr(equals + 1);
    const std::uint32_t index = index_of(name);
    const quiesce_param_info_t &info = *quiesce_param_info(index);
    const std::optional<std::int32_t> value = parse_value(info, text);
    if (!value || *value < info.min || *value > info.max) {
        const std::string labels = labels_of(info);
        throw InputError("--set " + assignment + ": " + name + " expects an integer in " +
                         std::to_string(info.min) + " .. " + std::to_string(info.max) + " " +
                         info.unit + (labels.empty() ? "" : " or one of: " + labels));
    }
    quiesce_param_set(&params, index, *value);
}

void require_accepted(const quiesce_params_t &params) {
    quiesce_param_error_t error{};
    if (!quiesce_params_check(&params, &error)) {
        throw InputError("parameter " + std::string(quiesce_param_info(error.index)->name) + ": " +
                         error.reason);
    }
}

std::string law_label(const quiesce_params_t &params) {
    return quiesce_param_info(index_of("law"))->labels[params.law];
}

} // namespace quiesce
