/// A controller that answers what a test tells it to.
#ifndef QUIESCE_SCRIPTED_LINK_H
#define QUIESCE_SCRIPTED_LINK_H

#include <functional>
#include <utility>

#include "controller_link.h"

namespace quiesce {

class ScriptedLink final : public ControllerLink {
  public:
    /// Called with each stimulus; returns the command.
    using Script = std::function<std::int32_t(const lockstep_stimulus_t &stimulus)>;

    explicit ScriptedLink(Script script) : script_(std::move(script)) {}

    std::string target() const override { return "scripted"; }
    StartAnswer start(const quiesce_board_t * /*board*/, const quiesce_params_t & /*params*/,
                      const Tables & /*tables*/) override {
        return {true};
    }
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override {
        reply = lockstep_reply_t{};
        reply.current_cmd_mA[0] = script_(stimulus);
        reply.drivers_enabled = 1;
    }
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

  private:
    Script script_;
};

/// The same command in every tick.
inline ScriptedLink constant_link(std::int32_t current_mA) {
    return ScriptedLink([current_mA](const lockstep_stimulus_t &) { return current_mA; });
}

} // namespace quiesce

#endif
