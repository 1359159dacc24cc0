/// Columns of a trace without a plant: time, stimulus and telemetry of a tick, all or some of them.
#ifndef QUIESCE_TICK_COLUMNS_H
#define QUIESCE_TICK_COLUMNS_H

#include <optional>
#include <string>
#include <vector>

#include "trace.h"

namespace quiesce {

class TickColumns {
  public:
    /// list: names separated by commas; all columns without it. Throws InputError, naming what
    /// there is, for a name that is none of them.
    explicit TickColumns(const std::optional<std::string> &list);

    std::vector<std::string> names() const;

    /// Appends one row.
    void put(double time_s, const lockstep_stimulus_t &stimulus,
             const quiesce_telemetry_t &telemetry, Trace &trace) const;

  private:
    std::vector<std::size_t> chosen_; ///< indices into all names
};

} // namespace quiesce

#endif
