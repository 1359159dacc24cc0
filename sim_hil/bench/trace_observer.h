/// Records a closed-loop run: true motion, coil, force, stimulus, telemetry.
#ifndef QUIESCE_TRACE_OBSERVER_H
#define QUIESCE_TRACE_OBSERVER_H

#include <cstdint>
#include <optional>
#include <string>

#include "run.h"
#include "tick_columns.h"
#include "trace.h"

namespace quiesce {

class TraceObserver final : public TickObserver {
  public:
    /// law: that runs. rig: null without a board. columns: names separated by commas, all without
    /// it; InputError for a name that is none of them. every: ticks from one row to the next.
    explicit TraceObserver(std::int32_t law, const Rig *rig = nullptr,
                           const std::optional<std::string> &columns = std::nullopt,
                           std::int64_t every = 1);

    void on_tick(const TickRecord &record) override;

    const Trace &trace() const { return trace_; }

  private:
    void put_rig(const TickRecord &record);

    const Rig *rig_;
    TickColumns columns_;
    std::int64_t every_;
    Trace trace_;
    std::vector<double> row_; ///< the columns before the controller's, of this tick
};

} // namespace quiesce

#endif
