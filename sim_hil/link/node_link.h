/// Target "host" with its CAN interface: the node that boards run, in this process, with a bus that
/// tools join as they join a real one.
#ifndef QUIESCE_NODE_LINK_H
#define QUIESCE_NODE_LINK_H

#include <memory>

#include "controller_link.h"
#include "firmware_node.h"
#include "multicast_bus.h"

namespace quiesce {

class NodeLink final : public ControllerLink {
  public:
    /// bus: none: what it sends nobody hears.
    explicit NodeLink(std::unique_ptr<MulticastBus> bus) : bus_(std::move(bus)) {}

    std::string target() const override { return "host"; }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;

    /// What the bus has by now, the tick, its frames. A frame that the bus does not take at once is
    /// dropped and counted, as a board's are.
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

    /// The last frames before it leaves the bus: safe currents, drivers off.
    void leave();

    /// How the next ticks come: lateness, work and overruns.
    lockstep_pace_t &pace() { return pace_; }

    /// In effect: tools on the bus may change them. Of another tick rate the next tick is one.
    const quiesce_params_t &params() const { return server_.node.params; }

  private:
    void receive_waiting();
    void send(const can_frame_t *frames, std::size_t count);

    std::unique_ptr<MulticastBus> bus_;
    Tables tables_; ///< of the last start: the node keeps no copy before it has them
    lockstep_node_t server_{};
    lockstep_pace_t pace_{};
};

} // namespace quiesce

#endif
