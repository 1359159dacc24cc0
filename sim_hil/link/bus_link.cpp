#include "bus_link.h"

namespace quiesce {

namespace {

constexpr std::chrono::milliseconds kMostWait(500);
constexpr std::int64_t kShift_ns = 5'000; // a tick: half a one is made up for in 0.1 s

} // namespace

BusLink::BusLink(std::unique_ptr<FrameChannel> controller, std::unique_ptr<MulticastBus> tools)
    : controller_(std::move(controller)), tools_(std::move(tools)) {}

StartAnswer BusLink::start(const quiesce_board_t *, const quiesce_params_t &params,
                           const Tables &) {
    tick_rate_Hz_ = params.tick_rate_Hz;
    plant_ = PlantFrames(tick_rate_Hz_);
    return {true};
}

void BusLink::send(const std::vector<can_frame_t> &frames) {
    const auto deadline = LinkClock::now() + kMostWait;
    for (std::size_t i = 0; i < frames.size(); i += kMaxBurstFrames) {
        controller_->send(frames.data() + i, std::min(kMaxBurstFrames, frames.size() - i),
                          deadline);
    }
}

void BusLink::pass_on_from_tools() {
    std::vector<can_frame_t> frames;
    can_frame_t frame{};
    for (std::size_t i = 0; tools_ && i < kMostFrames && tools_->receive(frame); ++i) {
        if (!PlantFrames::is_ours(frame)) {
            frames.push_back(frame);
        }
    }
    send(frames);
}

bool BusLink::take_from_controller() {
    const std::uint32_t demand = quiesce_can_messages[QUIESCE_CAN_AT_CURRENT_DEMAND].e2e.id;
    bool has_come = false;
    can_frame_t frame{};
    const auto now = LinkClock::now();
    for (std::size_t i = 0; i < kMostFrames && receive(frame, now); ++i) {
        has_come = has_come || frame.id == demand;
        plant_.take(frame);
        if (tools_ && !tools_->send(frame)) {
            can_unsent_count(&pace().unsent, frame.id);
        }
    }
    return has_come;
}

bool BusLink::receive(can_frame_t &frame, LinkClock::time_point deadline) {
    try {
        return controller_->receive(frame, deadline);
    } catch (const InputError &error) {
        throw TargetGone(error.what());
    }
}

void BusLink::half_way() {
    came_early_ = take_from_controller();
}

std::int64_t BusLink::shift_ns() {
    return came_early_ == came_late_ ? 0 : came_early_ ? -kShift_ns : kShift_ns;
}

void BusLink::look(lockstep_reply_t &reply) {
    came_late_ = take_from_controller();
    plant_.answer(reply);
}

void BusLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    try {
        send(plant_.of_tick(stimulus));
        pass_on_from_tools();
    } catch (const InputError &error) {
        throw TargetGone(error.what());
    }
    plant_.answer(reply);
}

void BusLink::leave() {
    send({plant_.release()});
}

} // namespace quiesce
