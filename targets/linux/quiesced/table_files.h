/// The files that [tables] names (docs/reference/table-files.md).
#ifndef QUIESCED_TABLE_FILES_H
#define QUIESCED_TABLE_FILES_H

#include <array>

#include "config.h"

namespace quiesced {

/// By quiesce_owner_t; empty where the configuration names none.
using ConfiguredTables = std::array<TableWords, QUIESCE_TABLE_OWNERS>;

/// Word 1 of every table; 0 without one.
inline std::uint32_t crc_of(const TableWords &words) {
    return words.size() > 1 ? words[1] : 0;
}

/// One of them, for a controller with this board (null: none). Throws InputError, "tables.law:
/// FILE: why", where it is no good table of that owner for that board.
TableWords load_table(const Config &config, quiesce_owner_t owner, const quiesce_board_t *board);

/// Both of them, likewise.
ConfiguredTables load_tables(const Config &config, const quiesce_board_t *board);

/// Throws InputError, likewise, where a controller with this board and these parameters refuses one
/// that is there.
void require_fit(const ConfiguredTables &tables, const Config &config, const quiesce_board_t *board,
                 const quiesce_params_t &params);

} // namespace quiesced

#endif
