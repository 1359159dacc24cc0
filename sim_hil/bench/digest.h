/// What a controller answered over a run, in a few numbers.
#ifndef QUIESCE_DIGEST_H
#define QUIESCE_DIGEST_H

#include <cstdint>
#include <set>

#include "crc32.h"
#include "run.h"

namespace quiesce {

class DigestObserver final : public TickObserver {
  public:
    void on_tick(const TickRecord &record) override { add(record.reply); }
    void add(const lockstep_reply_t &reply);

    std::uint32_t telemetry_crc32() const { return crc_.value(); }
    std::uint32_t fault_count() const {
        return fault_count_;
    } ///< faults that the controller entered
    const std::set<std::uint32_t> &faults_seen() const { return faults_seen_; } ///< their numbers
    std::size_t distinct_commands() const { return commands_.size(); }

  private:
    Crc32 crc_;
    std::uint32_t fault_count_ = 0;
    std::uint32_t last_fault_ = 0;
    std::int32_t last_command_mA_ = -1;
    std::set<std::uint32_t> faults_seen_;
    std::set<std::int32_t> commands_;
};

} // namespace quiesce

#endif
