/// A board from a file (docs/reference/boards.md): the one reader for bench, Linux controller and
/// images.
#ifndef QUIESCE_BOARD_FILE_H
#define QUIESCE_BOARD_FILE_H

#include <string>
#include <vector>

#include "quiesce.h"

namespace quiesce {

struct BoardFile {
    std::string name;
    std::vector<std::string> bodies, sensors, dampers; ///< names, by number on the board
    quiesce_board_t board;                             ///< checked
};

/// Throws InputError: one line naming file, table, key, what is wrong and what is allowed.
BoardFile load_board(const std::string &file);

/// Whether a parameter says what a board file says, so that it means nothing beside one.
bool is_of_board(const std::string &parameter);

/// A signal of such a board, by names: "stroke of upper".
std::string told(const BoardFile &file, const quiesce_signal_t &signal);

} // namespace quiesce

#endif
