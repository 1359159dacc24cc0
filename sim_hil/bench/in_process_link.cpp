#include "in_process_link.h"

#include "rule_file.h"

namespace quiesce {

bool InProcessLink::start(const quiesce_params_t &params) {
    server_ = lockstep_t{};
    const bool is_accepted = lockstep_start(&server_, &params);
    if (!rules_.empty()) {
        use_rules(server_.app.controller, rules_);
    }
    return is_accepted;
}

void InProcessLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    lockstep_exchange(&server_, &stimulus, &reply);
}

} // namespace quiesce
