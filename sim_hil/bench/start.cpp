#include "start.h"

#include "input_error.h"
#include "table_verdict.h"

namespace quiesce {

namespace {

/// Parameter number index, as the bench has it.
std::string refused_param(std::uint32_t index, const quiesce_params_t &params) {
    const quiesce_param_info_t *const info = quiesce_param_info(index);
    std::int32_t value = 0;
    if (info == nullptr || !quiesce_param_get(&params, index, &value)) {
        return "a parameter that there is not; rebuild it";
    }
    return std::string(info->name) + " = " + std::to_string(value) +
           ": what it asks for may be left out of its build, or another parameter contradicts it";
}

std::string refusal(const StartAnswer &answer, const quiesce_board_t *board,
                    const quiesce_params_t &params, const Tables &tables) {
    if (answer.param) {
        return refused_param(*answer.param, params);
    }
    if (answer.table.verdict != QUIESCE_TABLE_OK) {
        const char *whose =
            answer.table.table == LOCKSTEP_LAW_TABLE ? "the law's" : "the tracker's";
        const auto verdict = static_cast<quiesce_table_verdict_t>(answer.table.verdict);
        return std::string(whose) + " table: " + reason_of(verdict, tables.at(answer.table.table));
    }
    return board != nullptr ? "its parameters or its board; is it built for as many sensors and "
                              "dampers?"
                            : "its parameters";
}

} // namespace

void refuse_start(const ControllerLink &link, const StartAnswer &answer,
                  const quiesce_board_t *board, const quiesce_params_t &params,
                  const Tables &tables) {
    throw InputError("the controller on target " + link.target() + " refuses " +
                     refusal(answer, board, params, tables));
}

Tables tables_for(const quiesce_board_t *board, const quiesce_params_t &params,
                  const std::vector<TableWords> &given) {
    const auto trial = controller_with(board, params);
    Tables tables;
    for (const TableWords &words : given) {
        quiesce_owner_t owner = QUIESCE_OF_LAW;
        (void)quiesce_table_kind(words.front(), &owner);
        if (use_table(*trial, words) != QUIESCE_TABLE_MAGIC) {
            tables[owner == QUIESCE_OF_TRACKER ? LOCKSTEP_TRACKER_TABLE : LOCKSTEP_LAW_TABLE] =
                words;
        }
    }
    return tables;
}

void start_controller(ControllerLink &link, const quiesce_board_t *board,
                      const quiesce_params_t &params, const Tables &tables) {
    const StartAnswer answer = link.start(board, params, tables);
    if (!answer) {
        refuse_start(link, answer, board, params, tables);
    }
}

} // namespace quiesce
