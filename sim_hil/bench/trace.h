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

    /// Throws InputError when the file cannot be written; it is then not there, not half-written.
    void write(const std::string &file) const;

  private:
    std::vector<std::string> columns_;
    std::vector<double> values_;
};

} // namespace quiesce

#endif
