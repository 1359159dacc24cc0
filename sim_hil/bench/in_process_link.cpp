#include "in_process_link.h"

namespace quiesce {

bool InProcessLink::start(const quiesce_params_t &params) {
    server_ = lockstep_t{};
    return lockstep_start(&server_, &params);
}

void InProcessLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    lockstep_exchange(&server_, &stimulus, &reply);
}

} // namespace quiesce
