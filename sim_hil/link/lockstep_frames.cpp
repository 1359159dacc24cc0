#include "lockstep_frames.h"

#include <string>

#include "input_error.h"

namespace quiesce {

namespace {

constexpr std::int32_t kMax24Bit = 0x7FFFFF;

can_frame_t make_frame(std::uint32_t id, std::uint32_t length) {
    can_frame_t frame{};
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(length);
    return frame;
}

void require_24_bit(std::int32_t value, const char *name) {
    if (value < -kMax24Bit - 1 || value > kMax24Bit) {
        throw InputError(std::string(name) + " " + std::to_string(value) +
                         ": does not fit the 24 bits that it has in its CAN message");
    }
}

bool has_flag(const lockstep_stimulus_t &stimulus, std::uint32_t flag) {
    return (stimulus.flags & flag) != 0;
}

can_frame_t current_frame(const lockstep_stimulus_t &stimulus, std::uint8_t damper,
                          std::uint8_t sequence) {
    require_24_bit(stimulus.current_meas_mA[damper], "current_meas_mA");
    quiesce_can_lockstep_current_t current{};
    current.current_meas_mA = stimulus.current_meas_mA[damper];
    current.damper_number = damper;
    current.sequence = sequence;
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_CURRENT_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CURRENT_LENGTH);
    quiesce_can_lockstep_current_pack(frame.data, &current, sizeof frame.data);
    return frame;
}

can_frame_t sensor_frame(const lockstep_stimulus_t &stimulus, std::uint8_t number,
                         std::uint8_t sequence) {
    require_24_bit(stimulus.counts[number], "counts");
    quiesce_can_lockstep_sensor_t sensor{};
    sensor.sample_counts = stimulus.counts[number];
    sensor.sensor_number = number;
    sensor.sequence = sequence;
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_SENSOR_FRAME_ID, QUIESCE_CAN_LOCKSTEP_SENSOR_LENGTH);
    quiesce_can_lockstep_sensor_pack(frame.data, &sensor, sizeof frame.data);
    return frame;
}

can_frame_t stimulus_frame(const lockstep_stimulus_t &stimulus, std::uint8_t sequence) {
    require_24_bit(stimulus.counts[0], "counts");
    if (has_flag(stimulus, LOCKSTEP_LOST)) {
        throw InputError("fault lost_tick: there is no CAN message for it; expected target host or "
                         "link shm");
    }
    quiesce_can_lockstep_stimulus_t message{};
    message.accel_counts = stimulus.counts[0];
    message.accel_is_fresh = has_flag(stimulus, LOCKSTEP_FRESH);
    message.enable = has_flag(stimulus, LOCKSTEP_ENABLE);
    message.estop = has_flag(stimulus, LOCKSTEP_ESTOP);
    message.fault_reset = has_flag(stimulus, LOCKSTEP_FAULT_RESET);
    message.sequence = sequence;
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID, QUIESCE_CAN_LOCKSTEP_STIMULUS_LENGTH);
    quiesce_can_lockstep_stimulus_pack(frame.data, &message, sizeof frame.data);
    return frame;
}

} // namespace

std::size_t put_stimulus(const lockstep_stimulus_t &stimulus, std::uint8_t sequence,
                         can_frame_t *frames) {
    std::size_t count = 0;
    for (std::uint8_t i = 0; i < QUIESCE_MAX_DAMPERS; ++i) {
        if (has_flag(stimulus, LOCKSTEP_HAS_CURRENT << i)) {
            frames[count++] = current_frame(stimulus, i, sequence);
        }
    }
    for (std::uint8_t i = 1; i < QUIESCE_MAX_SENSORS; ++i) {
        if (has_flag(stimulus, LOCKSTEP_FRESH << i)) {
            frames[count++] = sensor_frame(stimulus, i, sequence);
        }
    }
    frames[count++] = stimulus_frame(stimulus, sequence);
    return count;
}

can_frame_t param_write(std::uint16_t index, std::int32_t value) {
    quiesce_can_lockstep_param_write_t write{};
    write.param_index = index;
    write.param_value = value;
    can_frame_t frame = make_frame(QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID,
                                   QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_LENGTH);
    quiesce_can_lockstep_param_write_pack(frame.data, &write, sizeof frame.data);
    return frame;
}

can_frame_t control_frame(std::uint8_t operation, TelemetryRate telemetry) {
    quiesce_can_lockstep_control_t message{};
    message.operation = operation;
    message.telemetry_frames = telemetry.frames;
    message.telemetry_every_ticks = telemetry.every_ticks;
    can_frame_t frame =
        make_frame(QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID, QUIESCE_CAN_LOCKSTEP_CONTROL_LENGTH);
    quiesce_can_lockstep_control_pack(frame.data, &message, sizeof frame.data);
    return frame;
}

} // namespace quiesce
