#include "start.h"

#include <memory>

#include "input_error.h"
#include "table_file.h"

namespace quiesce {

namespace {

std::string refusal(const StartAnswer &answer, const quiesce_board_t *board) {
    if (answer.table.verdict != QUIESCE_TABLE_OK) {
        const bool is_of_law = answer.table.table == LOCKSTEP_LAW_TABLE;
        return std::string(is_of_law ? "the law's" : "the tracker's") +
               " table: " + reason(static_cast<quiesce_table_verdict_t>(answer.table.verdict));
    }
    return board != nullptr ? "its parameters or its board; is it built for as many sensors and "
                              "dampers?"
                            : "its parameters";
}

} // namespace

Tables tables_for(const quiesce_board_t *board, const quiesce_params_t &params,
                  const std::vector<std::vector<std::uint32_t>> &given) {
    const auto trial = std::make_unique<lockstep_t>();
    lockstep_start(trial.get(), board, &params, nullptr);
    Tables tables;
    for (const std::vector<std::uint32_t> &words : given) {
        const auto count = static_cast<std::uint32_t>(words.size());
        const bool is_of_tracker =
            quiesce_tracker_table_check(words.data(), count) != QUIESCE_TABLE_MAGIC;
        if (quiesce_table_use(&trial->controller, words.data(), count) != QUIESCE_TABLE_MAGIC) {
            tables[is_of_tracker ? LOCKSTEP_TRACKER_TABLE : LOCKSTEP_LAW_TABLE] = words;
        }
    }
    return tables;
}

void start_controller(ControllerLink &link, const quiesce_board_t *board,
                      const quiesce_params_t &params, const Tables &tables) {
    const StartAnswer answer = link.start(board, params, tables);
    if (!answer) {
        throw InputError("the controller on target " + link.target() + " refuses " +
                         refusal(answer, board));
    }
}

} // namespace quiesce
