/// A controller with its CAN interface, run tick by tick: what boards run, wherever it is.
#ifndef QUIESCE_CONTROLLER_NODE_H
#define QUIESCE_CONTROLLER_NODE_H

#include <memory>
#include <string>
#include <vector>

#include "live_link.h"

namespace quiesce {

class ControllerNode {
  public:
    virtual ~ControllerNode() = default;

    virtual std::string target() const = 0;

    /// As ControllerLink::start.
    virtual StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                              const Tables &tables) = 0;

    /// A tick. heard: frames that have come before it, kMostFrames at the most. Returns those that
    /// it sends. Throws InputError where the controller cannot be reached.
    virtual std::vector<can_frame_t> tick(const std::vector<can_frame_t> &heard,
                                          const lockstep_stimulus_t &stimulus,
                                          const lockstep_pace_t &pace, lockstep_reply_t &reply) = 0;

    /// Of the parameters in effect.
    virtual std::int32_t tick_rate_Hz() const = 0;

    /// Its last frames: safe currents, drivers off. Call it at most once, as the last call.
    virtual std::vector<can_frame_t> farewell() = 0;
};

/// In this process.
std::unique_ptr<ControllerNode> make_node_here();

/// The image `quiesce_mps2_live` in the emulator. Throws InputError as QemuProcess does.
std::unique_ptr<ControllerNode> make_node_image(const std::string &image_path);

} // namespace quiesce

#endif
