/// Tables for the controller's laws and trackers, from table files (table_container.h).
#ifndef QUIESCE_TABLE_FILE_H
#define QUIESCE_TABLE_FILE_H

#include <cstdint>
#include <string>
#include <vector>

#include "firmware.h"

namespace quiesce {

/// Of a run; empty where none is given.
struct TableFiles {
    std::string rules;   ///< --rules: for law fuzzy
    std::string pulses;  ///< --pulses: for law phase
    std::string law;     ///< --law-table: for the law that runs
    std::string tracker; ///< --force-map: for its tracker
};

/// Words of each that is given. Throws InputError where a file is not a whole table file, or where
/// the controller refuses its table; of a law's table only require_tables looks at it.
std::vector<std::vector<std::uint32_t>> load_tables(const TableFiles &files);

/// Throws InputError where one is made for another board than this (null: none), where a controller
/// with this board and parameters refuses the law's or, after it, the tracker's, or lacks one.
void require_tables(const quiesce_board_t *board, const quiesce_params_t &params,
                    const TableFiles &files);

} // namespace quiesce

#endif
