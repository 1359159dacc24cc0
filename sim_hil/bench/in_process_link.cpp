#include "in_process_link.h"

#include "phase_table_file.h"
#include "rule_file.h"

namespace quiesce {

bool InProcessLink::start(const quiesce_params_t &params) {
    server_ = lockstep_t{};
    const bool is_accepted = lockstep_start(&server_, &params);
    if (!tables_.rules.empty()) {
        use_rules(server_.controller, tables_.rules);
    }
    if (!tables_.phase.empty()) {
        use_phase_table(server_.controller, tables_.phase);
    }
    return is_accepted;
}

void InProcessLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    lockstep_exchange(&server_, &stimulus, &reply);
}

} // namespace quiesce
