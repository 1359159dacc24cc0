#include "node_link.h"

#include "input_error.h"

namespace quiesce {

namespace {

/// Frames taken before a tick: a bus of 1 Mbit/s has a quarter of them in one of 10 ms. A storm of
/// them does not keep the tick from running.
constexpr std::size_t kMostReceived = 256;

} // namespace

StartAnswer NodeLink::start(const quiesce_board_t *board, const quiesce_params_t &params,
                            const Tables &tables) {
    server_ = lockstep_node_t{};
    tables_ = tables;
    std::array<lockstep_table_t, LOCKSTEP_TABLES> used{};
    for (std::size_t i = 0; i < used.size(); ++i) {
        used[i] = {tables_[i].data(), static_cast<std::uint32_t>(tables_[i].size())};
    }
    const bool is_accepted = lockstep_node_start(&server_, board, &params, used.data());
    return {is_accepted, server_.refused};
}

void NodeLink::receive_waiting() {
    can_frame_t frame{};
    for (std::size_t i = 0; i < kMostReceived && bus_->receive(frame); ++i) {
        node_receive(&server_.node, &frame);
    }
}

void NodeLink::send(const can_frame_t *frames, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        if (!bus_->send(frames[i])) {
            can_unsent_count(&pace_.unsent, frames[i].id);
        }
    }
}

void NodeLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    if (bus_) {
        receive_waiting();
    }
    std::array<can_frame_t, NODE_MAX_FRAMES> frames{};
    const std::uint32_t count =
        lockstep_node_exchange(&server_, &stimulus, &pace_, &reply, frames.data());
    if (bus_) {
        send(frames.data(), count);
    }
    if ((stimulus.flags & LOCKSTEP_PICTURE) == 0) {
        reply.picture = quiesce_picture_t{};
    }
}

void NodeLink::leave() {
    std::array<can_frame_t, QUIESCE_DAMPERS> frames{};
    const std::uint32_t count = node_farewell(&server_.node, frames.data());
    if (bus_) {
        send(frames.data(), count);
    }
}

} // namespace quiesce
