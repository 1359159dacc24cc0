/// Which current is safe for each damper, and how many dampers there are: as the board says, or the
/// parameters where there is none.
#ifndef SAFE_CURRENT_H
#define SAFE_CURRENT_H

#include "quiesce.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Of a board that quiesce_board_check accepts, or 1 where it refuses it or there is none (NULL).
uint32_t dampers_of_board(const quiesce_board_t *board);

/// What the controller commands damper 0 .. QUIESCE_DAMPERS - 1, mA, where nothing else is allowed:
/// the board's safe current, not above these parameters' max_current_mA (the default where they are
/// refused), 0 where the board is refused; without a board quiesce_params_safe_current_mA.
/// Some 2,000 instructions with a board: for starts, not for ticks.
int32_t safe_current_mA(const quiesce_board_t *board, const quiesce_params_t *params,
                        uint32_t damper);

#ifdef __cplusplus
}
#endif

#endif
