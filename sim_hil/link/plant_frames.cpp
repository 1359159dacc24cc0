#include "plant_frames.h"

#include <algorithm>

namespace quiesce {

namespace {

constexpr std::int32_t kMax24Bit = 0x7FFFFF;
constexpr std::int32_t kLetGoFrames = 4; ///< a panel is known from its third frame on
constexpr std::int32_t kResetFrames = 2; ///< that a press has to be seen in

const quiesce_can_message_t &row(std::size_t message) {
    return quiesce_can_messages[message];
}

bool has(const lockstep_stimulus_t &stimulus, std::uint32_t flag) {
    return (stimulus.flags & flag) != 0;
}

/// Rows of one kind lie beside each other, by number.
bool is_between(const can_frame_t &frame, std::size_t first, std::size_t count) {
    const std::uint32_t low = row(first).e2e.id;
    return !frame.is_extended && frame.id >= low && frame.id < low + count;
}

} // namespace

can_frame_t empty_frame(std::size_t message) {
    can_frame_t frame{};
    frame.id = row(message).e2e.id;
    frame.length = row(message).e2e.length;
    return frame;
}

PlantFrames::PlantFrames(std::int32_t tick_rate_Hz) : tick_rate_Hz_(tick_rate_Hz) {}

/// At least one, rounded up: nothing comes more often than its cycle says.
std::int32_t PlantFrames::ticks_of(std::uint32_t time_ms) const {
    const auto ticks = static_cast<std::int64_t>(time_ms) * tick_rate_Hz_;
    return std::max<std::int32_t>(1, static_cast<std::int32_t>((ticks + 999) / 1000));
}

/// Once a tick, in every one. True iff the message is sent now.
bool PlantFrames::is_due(std::size_t message) {
    Sender &sender = senders_[message];
    sender.wait_ticks -= sender.wait_ticks > 0 ? 1 : 0;
    return sender.wait_ticks == 0;
}

void PlantFrames::protect(std::size_t message, can_frame_t &frame) {
    e2e_protect(&row(message).e2e, &senders_[message].alive, &frame);
    senders_[message].wait_ticks = ticks_of(row(message).cycle_ms);
}

void PlantFrames::put_current(const lockstep_stimulus_t &stimulus, std::size_t damper,
                              std::vector<can_frame_t> &frames) {
    const std::size_t message = QUIESCE_CAN_AT_CURRENT_MEASURED + damper;
    if (!is_due(message) || !has(stimulus, LOCKSTEP_HAS_CURRENT << damper)) {
        return;
    }
    const Driver &driver = drivers_[damper];
    quiesce_can_current_measured_t current{};
    current.current_meas_mA = static_cast<std::int16_t>(
        std::clamp<std::int32_t>(stimulus.current_meas_mA[damper], INT16_MIN, INT16_MAX));
    current.driver_status =
        !driver.has_demand  ? QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_DEMAND_LOST_CHOICE
        : driver.is_enabled ? QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_OK_CHOICE
                            : QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_OFF_CHOICE;
    can_frame_t frame = empty_frame(message);
    quiesce_can_current_measured_pack(frame.data, &current, sizeof frame.data);
    protect(message, frame);
    frames.push_back(frame);
}

void PlantFrames::put_sample(const lockstep_stimulus_t &stimulus, std::size_t number,
                             std::vector<can_frame_t> &frames) {
    const std::size_t message = QUIESCE_CAN_AT_ACCEL_SAMPLE + number;
    is_fresh_[number] = is_fresh_[number] || has(stimulus, LOCKSTEP_FRESH << number);
    if (!is_due(message) || !is_fresh_[number]) {
        return;
    }
    is_fresh_[number] = false;
    quiesce_can_accel_sample_t sample{};
    sample.accel_counts = std::clamp(stimulus.counts[number], -kMax24Bit - 1, kMax24Bit);
    sample.is_saturated = sample.accel_counts != stimulus.counts[number];
    can_frame_t frame = empty_frame(message);
    quiesce_can_accel_sample_pack(frame.data, &sample, sizeof frame.data);
    protect(message, frame);
    frames.push_back(frame);
}

can_frame_t PlantFrames::panel(bool is_enabled, bool is_reset) {
    quiesce_can_operator_command_t command{};
    command.enable = is_enabled;
    command.fault_reset = is_reset;
    can_frame_t frame = empty_frame(QUIESCE_CAN_AT_OPERATOR_COMMAND);
    quiesce_can_operator_command_pack(frame.data, &command, sizeof frame.data);
    protect(QUIESCE_CAN_AT_OPERATOR_COMMAND, frame);
    return frame;
}

/// The enable counts only from a panel that has been seen to let it go. A reset lasts for as many
/// frames as it has to be seen in, however short it was.
void PlantFrames::put_operator(const lockstep_stimulus_t &stimulus,
                               std::vector<can_frame_t> &frames) {
    const bool is_reset = has(stimulus, LOCKSTEP_FAULT_RESET);
    resets_ = is_reset && !was_reset_ ? kResetFrames : resets_;
    was_reset_ = is_reset;
    if (!is_due(QUIESCE_CAN_AT_OPERATOR_COMMAND)) {
        return;
    }
    const bool has_let_go = panel_frames_ >= kLetGoFrames;
    frames.push_back(panel(has_let_go && has(stimulus, LOCKSTEP_ENABLE), resets_ > 0));
    panel_frames_ += has_let_go ? 0 : 1;
    resets_ -= resets_ > 0 ? 1 : 0;
}

/// Pressed, it does not wait for its cycle.
void PlantFrames::put_stop(const lockstep_stimulus_t &stimulus, std::vector<can_frame_t> &frames) {
    if (!is_due(QUIESCE_CAN_AT_EMERGENCY_STOP) || !has(stimulus, LOCKSTEP_ESTOP)) {
        return;
    }
    quiesce_can_emergency_stop_t stop{};
    stop.code = QUIESCE_CAN_EMERGENCY_STOP_CODE_STOP_CHOICE;
    can_frame_t frame = empty_frame(QUIESCE_CAN_AT_EMERGENCY_STOP);
    quiesce_can_emergency_stop_pack(frame.data, &stop, sizeof frame.data);
    protect(QUIESCE_CAN_AT_EMERGENCY_STOP, frame);
    frames.push_back(frame);
}

std::vector<can_frame_t> PlantFrames::of_tick(const lockstep_stimulus_t &stimulus) {
    const std::int32_t timeout_ticks = ticks_of(row(QUIESCE_CAN_AT_CURRENT_DEMAND).timeout_ms);
    for (Driver &driver : drivers_) {
        driver.age_ticks = std::min(driver.age_ticks + 1, timeout_ticks + 1);
        driver.has_demand = driver.has_demand && driver.age_ticks <= timeout_ticks;
    }
    std::vector<can_frame_t> frames;
    if (has(stimulus, LOCKSTEP_LOST)) {
        return frames;
    }
    put_stop(stimulus, frames);
    for (std::size_t i = 0; i < QUIESCE_MAX_SENSORS; ++i) {
        put_sample(stimulus, i, frames);
    }
    for (std::size_t i = 0; i < QUIESCE_MAX_DAMPERS; ++i) {
        put_current(stimulus, i, frames);
    }
    put_operator(stimulus, frames);
    return frames;
}

can_frame_t PlantFrames::release() {
    return panel(false, false);
}

bool PlantFrames::is_ours(const can_frame_t &frame) {
    return is_between(frame, QUIESCE_CAN_AT_ACCEL_SAMPLE, QUIESCE_MAX_SENSORS) ||
           is_between(frame, QUIESCE_CAN_AT_CURRENT_MEASURED, QUIESCE_MAX_DAMPERS) ||
           is_between(frame, QUIESCE_CAN_AT_OPERATOR_COMMAND, 1);
}

void PlantFrames::take_demand(std::size_t damper, const can_frame_t &frame) {
    if (e2e_check(&row(QUIESCE_CAN_AT_CURRENT_DEMAND + damper).e2e, &frame) != E2E_OK) {
        return;
    }
    quiesce_can_current_demand_t demand{};
    quiesce_can_current_demand_unpack(&demand, frame.data, frame.length);
    drivers_[damper] = {demand.current_cmd_mA, demand.driver_is_enabled != 0, 0, true};
}

void PlantFrames::take_status(const can_frame_t &frame) {
    if (e2e_check(&row(QUIESCE_CAN_AT_STATUS).e2e, &frame) != E2E_OK) {
        return;
    }
    quiesce_can_status_t status{};
    quiesce_can_status_unpack(&status, frame.data, frame.length);
    told_.state = status.state;
    told_.fault = status.fault;
    told_.fault_count = status.fault_count;
    told_.rms_um_s2 = static_cast<std::int32_t>(status.rms_um_s2);
}

void PlantFrames::take(const can_frame_t &frame) {
    if (is_between(frame, QUIESCE_CAN_AT_CURRENT_DEMAND, QUIESCE_MAX_DAMPERS)) {
        take_demand(frame.id - row(QUIESCE_CAN_AT_CURRENT_DEMAND).e2e.id, frame);
    } else if (is_between(frame, QUIESCE_CAN_AT_STATUS, 1)) {
        take_status(frame);
    }
}

void PlantFrames::answer(lockstep_reply_t &reply) const {
    reply = lockstep_reply_t{};
    for (std::size_t i = 0; i < drivers_.size(); ++i) {
        const Driver &driver = drivers_[i];
        const bool is_on = driver.has_demand && driver.is_enabled;
        reply.current_cmd_mA[i] = driver.has_demand ? driver.current_cmd_mA : 0;
        reply.drivers_enabled |= is_on ? 1u << i : 0u;
    }
    reply.telemetry = told_;
}

} // namespace quiesce
