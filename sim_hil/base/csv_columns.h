/// Columns of numbers from a CSV file: one header line of names, then one line of numbers a row.
#ifndef QUIESCE_CSV_COLUMNS_H
#define QUIESCE_CSV_COLUMNS_H

#include <cstddef>
#include <string>
#include <vector>

namespace quiesce {

struct CsvRow {
    std::size_t line;           ///< in the file, from 1
    std::vector<double> values; ///< finite, in the order of the names asked for
};

/// Reads these columns; others may hold anything. Blank lines, spaces around a cell, a byte order
/// mark and line ends of any system are taken. Throws InputError "FILE:LINE: ..." for what is
/// wrong.
std::vector<CsvRow> read_csv_columns(const std::string &file,
                                     const std::vector<std::string> &names);

} // namespace quiesce

#endif
