/// The controller with its CAN interface in this process.
#include <array>

#include "controller_node.h"

namespace quiesce {

namespace {

class NodeHere final : public ControllerNode {
  public:
    std::string target() const override { return "host"; }

    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override {
        server_ = lockstep_node_t{};
        tables_ = tables;
        std::array<lockstep_table_t, LOCKSTEP_TABLES> used{};
        for (std::size_t i = 0; i < used.size(); ++i) {
            used[i] = {tables_[i].data(), static_cast<std::uint32_t>(tables_[i].size())};
        }
        const bool is_accepted = lockstep_node_start(&server_, board, &params, used.data());
        return {is_accepted, server_.refused};
    }

    std::vector<can_frame_t> tick(const std::vector<can_frame_t> &heard,
                                  const lockstep_stimulus_t &stimulus, const lockstep_pace_t &pace,
                                  lockstep_reply_t &reply) override {
        for (const can_frame_t &frame : heard) {
            node_receive(&server_.node, &frame);
        }
        std::array<can_frame_t, NODE_MAX_FRAMES> frames{};
        const std::uint32_t count =
            lockstep_node_exchange(&server_, &stimulus, &pace, &reply, frames.data());
        return {frames.begin(), frames.begin() + count};
    }

    std::int32_t tick_rate_Hz() const override { return server_.node.params.tick_rate_Hz; }

    std::vector<can_frame_t> farewell() override {
        std::array<can_frame_t, QUIESCE_DAMPERS> frames{};
        const std::uint32_t count = node_farewell(&server_.node, frames.data());
        return {frames.begin(), frames.begin() + count};
    }

  private:
    Tables tables_; ///< of the last start: the node keeps no copy before it has them
    lockstep_node_t server_{};
};

} // namespace

std::unique_ptr<ControllerNode> make_node_here() {
    return std::make_unique<NodeHere>();
}

} // namespace quiesce
