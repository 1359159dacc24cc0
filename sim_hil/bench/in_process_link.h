/// The controller compiled into the bench itself: the fastest target, and the reference for all
/// others.
#ifndef QUIESCE_IN_PROCESS_LINK_H
#define QUIESCE_IN_PROCESS_LINK_H

#include "controller_link.h"
#include "state_archive.h"

namespace quiesce {

class InProcessLink final : public ControllerLink {
  public:
    std::string target() const override { return "host"; }
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

    /// Between two ticks, as quiesce_params_use.
    bool use_params(const quiesce_params_t &params) {
        return quiesce_params_use(&server_.controller, &params);
    }

    /// What changes while it runs (state_archive.h). It is loaded into one that has been started
    /// likewise. Throws InputError where that has other tables.
    void visit_state(StateArchive &archive);

  private:
    Tables tables_; ///< of the last start: they stay in use
    lockstep_t server_{};
};

} // namespace quiesce

#endif
