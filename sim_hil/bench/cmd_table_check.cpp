/// table-check: what the controller says of a table file, as JSON.
#include <iostream>

#include "arguments.h"
#include "board_crc.h"
#include "board_file.h"
#include "commands.h"
#include "json.h"
#include "table_container.h"
#include "table_verdict.h"

namespace quiesce {

namespace {

/// With a board, that too is told: whether the file is made for it.
Json check_json(const TableContainer &table, const std::optional<BoardFile> &board) {
    const quiesce_table_verdict_t verdict =
        board ? verdict_on(board->board, table.words) : verdict_of(table.words);
    const Takers takers = takers_of(table.words);
    const bool is_for = !board || table.board == 0 || table.board == board_crc32(board->board);
    return {{"verdict", static_cast<std::int32_t>(verdict)},
            {"reason", reason_of(verdict, table.words)},
            {"board", table.board},
            {"is_for_board", is_for},
            {"words", table.words.size()},
            {"laws", takers.laws},
            {"trackers", takers.trackers}};
}

} // namespace

int cmd_table_check(const std::vector<std::string> &words) {
    const Arguments arguments("table-check", words, {"file", "board"});
    arguments.require_no_positional();
    std::optional<BoardFile> board;
    if (const auto file = arguments.text("board")) {
        board = load_board(*file);
    }
    std::cout << check_json(read_table(arguments.required("file")), board).dump() << '\n';
    return 0;
}

} // namespace quiesce
