/// A controller with its CAN interface beside the plant: sensors, drivers and enable are wired to
/// it, and tools join its bus as they join a real one.
#ifndef QUIESCE_NODE_LINK_H
#define QUIESCE_NODE_LINK_H

#include <memory>

#include "controller_node.h"
#include "multicast_bus.h"

namespace quiesce {

class NodeLink final : public LiveLink {
  public:
    /// bus: none: what it sends nobody hears.
    NodeLink(std::unique_ptr<ControllerNode> node, std::unique_ptr<MulticastBus> bus)
        : node_(std::move(node)), bus_(std::move(bus)) {}

    std::string target() const override { return node_->target(); }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override {
        return node_->start(board, params, tables);
    }

    /// What the bus has by now, the tick, its frames. A frame that the bus does not take at once is
    /// dropped and counted, as a board's are. Throws TargetGone where the controller is.
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

    /// Safe currents, drivers off.
    void leave() override { send(node_->farewell()); }

    std::int32_t tick_rate_Hz() const override { return node_->tick_rate_Hz(); }

  private:
    std::vector<can_frame_t> heard();
    void send(const std::vector<can_frame_t> &frames);

    std::unique_ptr<ControllerNode> node_;
    std::unique_ptr<MulticastBus> bus_;
};

} // namespace quiesce

#endif
