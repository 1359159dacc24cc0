/// The controller compiled into the bench itself: the fastest target, and the reference for all
/// others.
#ifndef QUIESCE_IN_PROCESS_LINK_H
#define QUIESCE_IN_PROCESS_LINK_H

#include <cstdint>
#include <utility>
#include <vector>

#include "controller_link.h"

namespace quiesce {

class InProcessLink final : public ControllerLink {
  public:
    using Words = std::vector<std::uint32_t>;

    InProcessLink() = default;
    /// tables: of any kind; a law uses those that are made for it, else what ships.
    explicit InProcessLink(std::vector<Words> tables) : tables_(std::move(tables)) {}

    std::string target() const override { return "host"; }
    bool start(const quiesce_board_t *board, const quiesce_params_t &params) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

  private:
    std::vector<Words> tables_;
    lockstep_t server_{};
};

} // namespace quiesce

#endif
