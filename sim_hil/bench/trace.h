/// Trace files: one line of JSON {"columns": [...], "rows": N}, then N rows of little-endian
/// float64.
#ifndef QUIESCE_TRACE_H
#define QUIESCE_TRACE_H

#include <string>
#include <vector>

#include "run.h"

namespace quiesce {

class Trace {
  public:
    explicit Trace(std::vector<std::string> columns) : columns_(std::move(columns)) {}

    /// Appends one value; a row is complete with one value for each column.
    void put(double value) { values_.push_back(value); }

    /// Appends every telemetry field.
    void put_telemetry(const quiesce_telemetry_t &telemetry);

    /// Throws InputError when the file cannot be written; it is then not there, not half-written.
    void write(const std::string &file) const;

  private:
    std::vector<std::string> columns_;
    std::vector<double> values_;
};

/// Telemetry field number index (< telemetry_fields().size()) as a number.
double telemetry_value(const quiesce_telemetry_t &telemetry, std::size_t index);

/// names followed by every telemetry field's name.
std::vector<std::string> with_telemetry_columns(std::vector<std::string> names);

} // namespace quiesce

#endif
