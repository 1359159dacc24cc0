#include "wiring_text.h"

#include <array>
#include <cstdio>

#include "bus_load.h"
#include "names.h"

namespace quiesced {

namespace {

/// Messages go by the number on the board: which driver listens to which is worth a look.
std::string message_text(std::uint32_t first_id, std::size_t number) {
    std::array<char, 32> text{};
    (void)std::snprintf(text.data(), text.size(), " 0x%03X",
                        static_cast<unsigned>(first_id + number));
    return text.data();
}

std::string source_text(const SensorConfig &sensor, std::size_t number) {
    std::string out = source_name(sensor.source);
    if (sensor.source == SensorSource::can) {
        return out + message_text(QUIESCE_CAN_ACCEL_SAMPLE_FRAME_ID, number);
    }
    out += sensor.device.empty() ? "" : " " + sensor.device;
    return out + (sensor.channel.empty() ? "" : " channel " + sensor.channel);
}

std::string output_text(const OutputConfig &output, std::size_t number) {
    std::string out = output_name(output.output);
    if (output.output == CurrentOutput::can) {
        out += message_text(QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID, number);
    } else {
        out += " " + output.device + " channel " + std::to_string(output.channel) + ", " +
               std::to_string(output.full_scale_mA) + " mA at full scale";
    }
    return out;
}

std::string damper_text(const Config &config, std::size_t damper) {
    const quiesce_board_t *board = config.wiring();
    std::string out = output_text(config.outputs[damper], damper);
    if (board != nullptr) {
        out += ", ceiling " + std::to_string(board->damper[damper].ceiling_mA) + " mA, safe " +
               std::to_string(board->damper[damper].safe_mA) + " mA";
    }
    return out;
}

std::string load_text(const Config &config) {
    const BusLoad load = bus_load(config, config.params);
    std::array<char, 160> text{};
    (void)std::snprintf(
        text.data(), text.size(),
        "CAN load: %.1f %% at %u bit/s (demands %.1f, samples %.1f, others %.1f)\n", load.total(),
        static_cast<unsigned>(config.can->bitrate != 0 ? config.can->bitrate : kUsualBitrate),
        load.demands, load.samples, load.others);
    return text.data();
}

} // namespace

std::string wiring_text(const Config &config) {
    std::string out;
    if (config.board) {
        out += "board " + config.board->board.name + ": " + config.board->file + "\n";
    }
    for (std::size_t i = 0; i < config.sensors.size(); ++i) {
        out += config.sensors[i].place.title + ": " + source_text(config.sensors[i], i) + "\n";
    }
    for (std::size_t i = 0; i < config.outputs.size(); ++i) {
        out += config.outputs[i].place.title + ": " + damper_text(config, i) + "\n";
    }
    return config.can ? out + load_text(config) : out;
}

} // namespace quiesced
