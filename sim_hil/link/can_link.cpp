#include "can_link.h"

#include <utility>

namespace quiesce {

namespace {

const char *const kSilenceHint = "; is quiesced --lockstep running at the other end?";

} // namespace

CanLink::CanLink(std::unique_ptr<FrameChannel> channel, const CanLinkOptions &options)
    : channel_(std::move(channel)),
      client_(*channel_, {options.telemetry, options.answer_time, kSilenceHint}),
      greeting_time_(options.greeting_time), is_complete_(options.telemetry.is_full()) {}

StartAnswer CanLink::start(const quiesce_board_t *board, const quiesce_params_t &params,
                           const Tables &tables) {
    if (!is_greeted_) {
        client_.greet(greeting_time_);
        is_greeted_ = true;
    }
    return client_.start(board, params, tables);
}

void CanLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    client_.exchange(stimulus, reply);
}

} // namespace quiesce
