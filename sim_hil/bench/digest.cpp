#include "digest.h"

#include <cstring>

namespace quiesce {

void DigestObserver::add(const lockstep_reply_t &reply) {
    std::uint32_t words[sizeof reply.telemetry / 4];
    std::memcpy(words, &reply.telemetry, sizeof words);
    crc_.append(words, sizeof words / 4);
    fault_count_ = reply.telemetry.fault_count;
    if (reply.telemetry.fault != last_fault_) {
        last_fault_ = reply.telemetry.fault;
        if (last_fault_ != QUIESCE_FAULT_NONE) {
            faults_seen_.insert(last_fault_);
        }
    }
    if (reply.current_cmd_mA[0] != last_command_mA_) {
        last_command_mA_ = reply.current_cmd_mA[0];
        commands_.insert(last_command_mA_);
    }
}

} // namespace quiesce
