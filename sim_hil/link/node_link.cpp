#include "node_link.h"

namespace quiesce {

std::vector<can_frame_t> NodeLink::heard() {
    std::vector<can_frame_t> frames;
    can_frame_t frame{};
    while (bus_ && frames.size() < kMostFrames && bus_->receive(frame)) {
        frames.push_back(frame);
    }
    return frames;
}

void NodeLink::send(const std::vector<can_frame_t> &frames) {
    for (const can_frame_t &frame : frames) {
        if (bus_ && !bus_->send(frame)) {
            can_unsent_count(&pace().unsent, frame.id);
        }
    }
}

void NodeLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    try {
        send(node_->tick(heard(), stimulus, pace(), reply));
    } catch (const InputError &error) {
        throw TargetGone(error.what());
    }
    if ((stimulus.flags & LOCKSTEP_PICTURE) == 0) {
        reply.picture = quiesce_picture_t{};
    }
}

} // namespace quiesce
