/// Target "linux": the program `quiesced --lockstep`, wherever it runs, over a CAN channel.
#ifndef QUIESCE_CAN_LINK_H
#define QUIESCE_CAN_LINK_H

#include <memory>

#include "lockstep_client.h"

namespace quiesce {

struct CanLinkOptions {
    TelemetryRate telemetry = kFullTelemetry;
    /// Longest wait for the first answer: the target may start after the bench.
    std::chrono::milliseconds greeting_time = std::chrono::seconds(10);
    /// Longest wait for each further answer.
    std::chrono::milliseconds answer_time = std::chrono::seconds(10);
};

class CanLink final : public ControllerLink {
  public:
    CanLink(std::unique_ptr<FrameChannel> channel, const CanLinkOptions &options);

    std::string target() const override { return "linux"; }

    /// The first start waits for the target.
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    bool is_complete() const override { return is_complete_; }
    bool has_picture() const override { return false; }
    ReplyWords received() const override { return client_.received(); }

    /// The target is left running, for the next bench: it is a service, no child of this one.
    std::optional<InstructionCounts> finish() override { return std::nullopt; }

  private:
    std::unique_ptr<FrameChannel> channel_;
    LockstepClient client_;
    std::chrono::milliseconds greeting_time_;
    bool is_complete_;
    bool is_greeted_ = false;
};

} // namespace quiesce

#endif
