#include "bus_load.h"

#include <algorithm>

namespace quiesced {

namespace {

constexpr std::uint32_t kPerSecond_us = 1'000'000;
constexpr std::uint32_t kPerMs_us = 1000;
constexpr double kPercent = 100.0;

double frame_s(const CanConfig &can, std::uint32_t bytes) {
    const double bitrate = can.bitrate != 0 ? can.bitrate : kUsualBitrate;
    if (can.use_fd && can.data_bitrate != 0) {
        const FdBits bits = fd_bits(bytes);
        return bits.nominal / bitrate + static_cast<double>(bits.data) / can.data_bitrate;
    }
    return classic_bits(bytes) / bitrate;
}

bool is_one_of(std::uint32_t message, std::uint32_t first, std::uint32_t most) {
    return message >= first && message < first + most;
}

/// Whether the bus of this configuration has a message that is sent by the clock.
bool is_there(const Config &config, std::uint32_t message) {
    if (is_one_of(message, QUIESCE_CAN_AT_CURRENT_DEMAND, QUIESCE_MAX_DAMPERS)) {
        return message - QUIESCE_CAN_AT_CURRENT_DEMAND < config.outputs.size();
    }
    if (is_one_of(message, QUIESCE_CAN_AT_ACCEL_SAMPLE, QUIESCE_MAX_SENSORS)) {
        return (config.sensors_on_bus() >> (message - QUIESCE_CAN_AT_ACCEL_SAMPLE) & 1U) != 0;
    }
    if (is_one_of(message, QUIESCE_CAN_AT_CURRENT_MEASURED, QUIESCE_MAX_DAMPERS)) {
        const std::uint32_t damper = message - QUIESCE_CAN_AT_CURRENT_MEASURED;
        return damper < config.outputs.size() &&
               config.outputs[damper].output == CurrentOutput::can;
    }
    return message != QUIESCE_CAN_AT_RAW_SAMPLE && message != QUIESCE_CAN_AT_FAULT_RECORD &&
           quiesce_can_messages[message].cycle_ms != 0;
}

/// Between two frames of a message.
std::uint32_t period_us(const Config &config, std::uint32_t message, std::uint32_t tick_us) {
    const std::uint32_t cycle_us = quiesce_can_messages[message].cycle_ms * kPerMs_us;
    const std::uint32_t sensor = message - QUIESCE_CAN_AT_ACCEL_SAMPLE;
    const quiesce_board_t *board = config.wiring();
    if (board != nullptr && sensor < QUIESCE_MAX_SENSORS && board->sensor[sensor].period_us != 0) {
        return static_cast<std::uint32_t>(board->sensor[sensor].period_us);
    }
    return std::max(cycle_us, tick_us);
}

} // namespace

std::uint32_t classic_bits(std::uint32_t bytes) {
    const std::uint32_t stuffed = 34 + 8 * bytes; // bits that stuff bits may go between
    return 8 * bytes + 47 + (stuffed - 1) / 4;
}

// ISO 11898-1, base format, BRS set, CRC-17: SOF to BRS are 17 bits, CRC delimiter to the
// inter-frame space 13. ESI, DLC, data, stuff count (4), CRC (17) and their 6 fixed stuff bits are
// at the data's rate. Every fourth bit before the stuff count may bring a stuff bit, of which those
// of the slow part count as slow.
FdBits fd_bits(std::uint32_t bytes) {
    constexpr std::uint32_t kBefore = 17;
    constexpr std::uint32_t kAfter = 13;
    constexpr std::uint32_t kCheck = 4 + 17 + 6;
    const std::uint32_t dynamic = kBefore + 5 + 8 * bytes;
    const std::uint32_t slow_stuffing = (kBefore - 1) / 4;
    const std::uint32_t stuffing = (dynamic - 1) / 4;
    return {kBefore + kAfter + slow_stuffing,
            dynamic - kBefore + stuffing - slow_stuffing + kCheck};
}

BusLoad bus_load(const Config &config, const quiesce_params_t &params) {
    const std::uint32_t tick_us = kPerSecond_us / static_cast<std::uint32_t>(params.tick_rate_Hz);
    BusLoad load{};
    for (std::uint32_t message = 0; message < QUIESCE_CAN_MESSAGES; ++message) {
        if (!is_there(config, message)) {
            continue;
        }
        const std::uint32_t bytes = quiesce_can_messages[message].e2e.length;
        const double pct = kPercent * frame_s(*config.can, bytes) * kPerSecond_us /
                           period_us(config, message, tick_us);
        const bool is_demand =
            is_one_of(message, QUIESCE_CAN_AT_CURRENT_DEMAND, QUIESCE_MAX_DAMPERS);
        const bool is_sample = is_one_of(message, QUIESCE_CAN_AT_ACCEL_SAMPLE, QUIESCE_MAX_SENSORS);
        (is_demand ? load.demands : is_sample ? load.samples : load.others) += pct;
    }
    return load;
}

} // namespace quiesced
