#include "safe_current.h"

#include <stddef.h>

uint32_t dampers_of_board(const quiesce_board_t *board) {
    const bool is_usable = board != NULL && quiesce_board_check(board, NULL);
    return is_usable ? (uint32_t)board->dampers : 1u;
}

// As quiesce_init_board does it.
static int32_t of_board_mA(const quiesce_board_damper_t *damper, const quiesce_params_t *params) {
    quiesce_params_t used = *params;
    if (!quiesce_params_check(params, NULL)) {
        quiesce_params_default(&used);
    }
    return damper->safe_mA < used.max_current_mA ? damper->safe_mA : used.max_current_mA;
}

int32_t safe_current_mA(const quiesce_board_t *board, const quiesce_params_t *params,
                        uint32_t damper) {
    if (board == NULL) {
        return damper == 0u ? quiesce_params_safe_current_mA(params) : 0;
    }
    const bool has_damper = quiesce_board_check(board, NULL) && damper < (uint32_t)board->dampers;
    return has_damper ? of_board_mA(&board->damper[damper], params) : 0;
}
