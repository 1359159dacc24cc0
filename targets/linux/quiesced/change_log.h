/// Log lines about what has changed: each change once, losses at most once a second.
#ifndef QUIESCED_CHANGE_LOG_H
#define QUIESCED_CHANGE_LOG_H

#include <array>

#include "exchange.h"

namespace quiesced {

class ChangeLog {
  public:
    explicit ChangeLog(LogRing &log) : log_(log) {}

    void control(const quiesce_telemetry_t &telemetry);
    void bus(const can_bus_t *bus);
    void overruns(std::uint32_t overruns, LossCause cause, std::int64_t now_ns);
    /// Of an output of the configuration, by its number.
    void failed_writes(std::size_t number, const char *title, std::uint32_t failures,
                       std::int64_t now_ns);

    /// The last different faults that were entered, the newest first; then NONE.
    const std::array<FaultEvent, Snapshot::kFaults> &faults() const { return faults_; }

  private:
    /// Something that is counted; told when it has grown and a second has passed.
    struct Counted {
        std::uint32_t told = 0;
        std::int64_t next_ns = 0;
        bool is_news(std::uint32_t count, std::int64_t now_ns);
    };

    void keep_fault(const quiesce_telemetry_t &telemetry);

    LogRing &log_;
    std::uint32_t state_ = QUIESCE_STATE_INIT;
    std::uint32_t fault_ = QUIESCE_FAULT_NONE;
    std::uint32_t bus_event_ = 0;
    Counted overruns_;
    std::array<Counted, QUIESCE_DAMPERS> failed_writes_;
    std::array<FaultEvent, Snapshot::kFaults> faults_{};
};

} // namespace quiesced

#endif
