#include "bus.h"

#include <array>
#include <vector>

#include "clock.h"
#include "input_error.h"

namespace quiesced {

namespace {

constexpr std::array<std::uint32_t, 5> kLockstepIds = {
    QUIESCE_CAN_LOCKSTEP_CONTROL_FRAME_ID, QUIESCE_CAN_LOCKSTEP_PARAM_WRITE_FRAME_ID,
    QUIESCE_CAN_LOCKSTEP_CURRENT_FRAME_ID, QUIESCE_CAN_LOCKSTEP_STIMULUS_FRAME_ID,
    QUIESCE_CAN_LOCKSTEP_SENSOR_FRAME_ID};

/// What node_receive takes.
std::vector<std::uint32_t> controller_ids() {
    std::vector<std::uint32_t> ids = {
        QUIESCE_CAN_EMERGENCY_STOP_FRAME_ID, QUIESCE_CAN_OPERATOR_COMMAND_FRAME_ID,
        QUIESCE_CAN_SERVICE_REQUEST_FRAME_ID, QUIESCE_CAN_TABLE_DATA_FRAME_ID};
    for (std::uint32_t i = 0; i < QUIESCE_SENSORS; ++i) {
        ids.push_back(QUIESCE_CAN_ACCEL_SAMPLE_FRAME_ID + i);
    }
    for (std::uint32_t i = 0; i < QUIESCE_DAMPERS; ++i) {
        ids.push_back(QUIESCE_CAN_CURRENT_MEASURED_FRAME_ID + i);
    }
    return ids;
}

} // namespace

Bus open_bus(const CanConfig &config, BusUse use) {
    const bool is_lockstep = use == BusUse::lockstep;
    can_bus_options_t options{};
    options.interface = config.interface.c_str();
    options.use_fd = config.use_fd;
    options.serial_baud = config.serial_baud;
    options.bitrate = config.is_serial() ? config.bitrate : 0;
    const std::vector<std::uint32_t> ids =
        is_lockstep ? std::vector<std::uint32_t>(kLockstepIds.begin(), kLockstepIds.end())
                    : controller_ids();
    options.ids = ids.data();
    options.id_count = static_cast<std::uint32_t>(ids.size());
    options.restart_ms = config.restart_ms;
    linux_error_t error{};
    Bus bus(can_bus_open(&options, &error));
    if (bus == nullptr) {
        throw quiesce::InputError(std::string("can.interface: ") + error.text);
    }
    return bus;
}

bool send_patiently(can_bus_t *bus, const can_frame_t &frame, int patience_ms) {
    for (int i = 0; i < patience_ms; ++i) {
        if (can_bus_send(bus, &frame)) {
            return true;
        }
        can_bus_repair(bus, monotonic_ns());
        sleep_ms(1);
    }
    return false;
}

} // namespace quiesced
