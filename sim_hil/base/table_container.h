/// The one kind of file for tables of the controller, docs/reference/table-files.md: four words of
/// its own, then the table.
#ifndef QUIESCE_TABLE_CONTAINER_H
#define QUIESCE_TABLE_CONTAINER_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace quiesce {

constexpr std::size_t kLeastTableWords = 4, kMostTableWords = 2048;

struct TableContainer {
    std::uint32_t board;              ///< CRC-32 of the board that it is made for; 0: any
    std::vector<std::uint32_t> words; ///< kLeastTableWords .. kMostTableWords
};

/// Throws InputError, one line with file and reason, where the file cannot be read or is not one
/// whole table file. The table's own head is not looked at: the controller checks it.
TableContainer read_table(const std::string &file);

} // namespace quiesce

#endif
