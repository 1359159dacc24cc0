/// Numbers from CSV files: columns below a header line of names, or all of a file without one.
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

/// Reads a file without a header, all lines of it, under the same rules. Throws InputError also
/// where it has no number at all.
std::vector<CsvRow> read_csv_numbers(const std::string &file);

} // namespace quiesce

#endif
