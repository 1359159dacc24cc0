/// The start of a controller for a run: which of the user's tables it gets, and what it says.
#ifndef QUIESCE_START_H
#define QUIESCE_START_H

#include <vector>

#include "controller_link.h"

namespace quiesce {

/// Of the tables given, in this order, the last that the law of these parameters works with, and
/// the last of its tracker; whether they are good is for the target to say. Others stay here.
/// board: null: none.
Tables tables_for(const quiesce_board_t *board, const quiesce_params_t &params,
                  const std::vector<std::vector<std::uint32_t>> &given);

/// Throws InputError with what the target refuses. answer: its own, a refusal.
[[noreturn]] void refuse_start(const ControllerLink &link, const StartAnswer &answer,
                               const quiesce_board_t *board, const quiesce_params_t &params,
                               const Tables &tables);

/// Throws InputError where the target refuses parameters, board or a table.
void start_controller(ControllerLink &link, const quiesce_board_t *board,
                      const quiesce_params_t &params, const Tables &tables);

} // namespace quiesce

#endif
