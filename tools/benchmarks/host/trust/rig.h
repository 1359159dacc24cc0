/// Boards and parameters at random, as far as they are accepted.
#ifndef RIG_H
#define RIG_H

#include "dice.h"
#include "quiesce.h"

typedef struct {
    quiesce_params_t params;
    quiesce_board_t board;
    bool has_board; ///< else the parameters say what is wired
} rig_t;

/// Parameters that are accepted, and now and then a board.
void rig_draw(rig_t *self, dice_t *dice);

/// Sets one parameter to any value of its range, or near its default.
void rig_draw_param(quiesce_params_t *params, dice_t *dice);

/// Starts a controller with it. Returns false iff something is refused: a signal may be missing.
bool rig_start(const rig_t *self, quiesce_t *controller);

/// How many dampers it has.
uint32_t rig_dampers(const rig_t *self);

/// No command of a damper may be above it, mA.
int32_t rig_limit_mA(const rig_t *self, uint32_t damper);

/// What a damper gets where nothing else is allowed, mA.
int32_t rig_safe_mA(const rig_t *self, uint32_t damper);

#endif
