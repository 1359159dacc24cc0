/// The controller compiled into the bench itself: the fastest target, and the reference for all
/// others.
#ifndef QUIESCE_IN_PROCESS_LINK_H
#define QUIESCE_IN_PROCESS_LINK_H

#include "controller_link.h"

namespace quiesce {

class InProcessLink final : public ControllerLink {
  public:
    std::string target() const override { return "host"; }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

  private:
    Tables tables_; ///< of the last start: they stay in use
    lockstep_t server_{};
};

} // namespace quiesce

#endif
