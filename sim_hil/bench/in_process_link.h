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
    /// rules: words of a rule table for the controller; none: the one that ships.
    explicit InProcessLink(std::vector<std::uint32_t> rules = {}) : rules_(std::move(rules)) {}

    std::string target() const override { return "host"; }
    bool start(const quiesce_params_t &params) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

  private:
    std::vector<std::uint32_t> rules_;
    lockstep_t server_{};
};

} // namespace quiesce

#endif
