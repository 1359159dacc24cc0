#include "frame_sender.h"

#include <algorithm>

namespace quiesced {

namespace {

constexpr std::uint32_t kFirstDemand = QUIESCE_CAN_AT_CURRENT_DEMAND;

// What is shed last goes first.
constexpr std::uint32_t kTelemetry[] = {
    QUIESCE_CAN_AT_CAN_SHED,       QUIESCE_CAN_AT_CAN_HEALTH,     QUIESCE_CAN_AT_LOOP_TIMING,
    QUIESCE_CAN_AT_LOOP_CYCLES,    QUIESCE_CAN_AT_IDENTIFICATION, QUIESCE_CAN_AT_MOTION,
    QUIESCE_CAN_AT_LAW_STATE,      QUIESCE_CAN_AT_SPECTRUM_PEAK0, QUIESCE_CAN_AT_SPECTRUM_PEAK1,
    QUIESCE_CAN_AT_SPECTRUM_PEAK2, QUIESCE_CAN_AT_RAW_SAMPLE,     QUIESCE_CAN_AT_FAULT_RECORD,
};

// Output stage and state are below the alive counter.
constexpr std::size_t kStateByte = 2;
constexpr std::uint32_t kStateMask = 0x0F;

std::uint32_t state_of(const can_frame_t &demand) {
    return demand.data[kStateByte] & kStateMask;
}

std::uint32_t message_of(const can_frame_t &frame) {
    std::uint32_t message = 0;
    while (message < QUIESCE_CAN_MESSAGES && quiesce_can_messages[message].e2e.id != frame.id) {
        ++message;
    }
    return message;
}

} // namespace

void FrameSender::replace(std::uint32_t message, const can_frame_t &frame) {
    Slot &slot = slots_[message];
    if (slot.waits) {
        can_unsent_count(&counters_.unsent, frame.id);
    }
    slot = {frame, true};
}

template <std::size_t kRoom>
void FrameSender::append(Row<kRoom> &row, const can_frame_t &frame) {
    if (row.count == kRoom) {
        can_unsent_count(&counters_.unsent, frame.id);
        return;
    }
    row.frames[(row.first + row.count) % kRoom] = frame;
    ++row.count;
}

void FrameSender::take(const can_frame_t &frame) {
    const std::uint32_t message = message_of(frame);
    if (message == QUIESCE_CAN_AT_SERVICE_REPLY) {
        append(replies_, frame);
    } else if (message == QUIESCE_CAN_AT_TABLE_FLOW) {
        append(flow_, frame);
    } else if (message == QUIESCE_CAN_AT_FAULT_FREEZE) {
        append(pages_, frame);
    } else if (message < QUIESCE_CAN_MESSAGES) {
        replace(message, frame);
    }
}

bool FrameSender::has_left_over() const {
    return replies_.count > 0 || flow_.count > 0 || pages_.count > 0 ||
           std::any_of(slots_.begin(), slots_.end(), [](const Slot &slot) { return slot.waits; });
}

bool FrameSender::is_urgent(std::size_t damper, std::int64_t now_ns) const {
    const Demand &demand = demands_[damper];
    return now_ns - demand.left_ns >= kRepeatEvery_ns ||
           state_of(slots_[kFirstDemand + damper].frame) != state_of(demand.last);
}

bool FrameSender::leave(Way &way, const can_frame_t &frame) {
    way.is_open = way.is_open && way.sink(way.context, &frame);
    return way.is_open;
}

void FrameSender::send_slot(Way &way, std::uint32_t message) {
    Slot &slot = slots_[message];
    slot.waits = slot.waits && !leave(way, slot.frame);
}

template <std::size_t kRoom>
void FrameSender::send_row(Way &way, Row<kRoom> &row) {
    while (row.count > 0 && leave(way, row.frames[row.first])) {
        row.first = (row.first + 1) % kRoom;
        --row.count;
    }
}

void FrameSender::send_demands(Way &way, std::int64_t now_ns, bool only_urgent) {
    for (std::size_t damper = 0; damper < demands_.size(); ++damper) {
        Slot &slot = slots_[kFirstDemand + damper];
        if (slot.waits && (!only_urgent || is_urgent(damper, now_ns)) && leave(way, slot.frame)) {
            slot.waits = false;
            demands_[damper] = {slot.frame, now_ns};
        }
    }
}

std::int64_t FrameSender::send(Sink sink, void *context, const can_frame_t *frames,
                               std::uint32_t count, std::int64_t now_ns) {
    Way way{sink, context, true};
    const bool is_congested = has_left_over();
    bool has_demand = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        take(frames[i]);
        has_demand =
            has_demand || frames[i].id - QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID < QUIESCE_MAX_DAMPERS;
    }
    send_demands(way, now_ns, is_congested);
    send_slot(way, QUIESCE_CAN_AT_STATUS);
    send_row(way, replies_);
    send_row(way, flow_);
    send_row(way, pages_);
    send_demands(way, now_ns, false);
    for (const std::uint32_t message : kTelemetry) {
        send_slot(way, message);
    }
    counters_.refused += way.is_open ? 0U : 1U;
    const auto demands = slots_.begin() + kFirstDemand;
    const bool all_left = std::none_of(demands, demands + QUIESCE_MAX_DAMPERS,
                                       [](const Slot &slot) { return slot.waits; });
    return has_demand && all_left ? now_ns : 0;
}

} // namespace quiesced
