/// Columns of a trace: values of its own, then the telemetry of a tick; all or some of them.
#ifndef QUIESCE_TICK_COLUMNS_H
#define QUIESCE_TICK_COLUMNS_H

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "trace.h"

namespace quiesce {

class TickColumns {
  public:
    /// own: names of the columns before the telemetry. list: names separated by commas; all columns
    /// without it. Throws InputError, naming what there is, for a name that is none of them.
    TickColumns(std::vector<std::string> own, const std::optional<std::string> &list);

    std::vector<std::string> names() const;

    /// Appends one row. own: the values, in the order of their names.
    void put(std::initializer_list<double> own, const quiesce_telemetry_t &telemetry,
             Trace &trace) const;

  private:
    std::size_t own_count_;
    std::vector<std::string> all_names_;
    std::vector<std::size_t> chosen_; ///< indices into all names
};

} // namespace quiesce

#endif
