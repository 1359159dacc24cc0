#include "in_process_link.h"

namespace quiesce {

bool InProcessLink::start(const quiesce_board_t *board, const quiesce_params_t &params) {
    server_ = lockstep_t{};
    const bool is_accepted = lockstep_start(&server_, board, &params);
    for (const Words &words : tables_) {
        (void)quiesce_table_use(&server_.controller, words.data(),
                                static_cast<std::uint32_t>(words.size()));
    }
    return is_accepted;
}

void InProcessLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    lockstep_exchange(&server_, &stimulus, &reply);
    if ((stimulus.flags & LOCKSTEP_PICTURE) == 0) {
        reply.picture = quiesce_picture_t{};
    }
}

} // namespace quiesce
