/// A controller at a moment, and what comes next: flips start from it.
#ifndef SCENE_H
#define SCENE_H

#include "dice.h"
#include "quiesce.h"
#include "rig.h"

enum { SCENE_TICKS = 64 };

typedef enum {
    SCENE_RUNNING,
    SCENE_STOPPING, ///< e-stop is held
    SCENE_STOPPED,  ///< e-stop has been released, its fault is latched
    SCENE_IDLE,     ///< not enabled
    SCENES
} scene_kind_t;

/// What the controller does in a tick if nothing is flipped.
typedef struct {
    uint32_t state, fault;
    bool is_off; ///< its drivers
} scene_tick_t;

typedef struct {
    rig_t rig;
    quiesce_t controller;
    quiesce_in_t in[SCENE_TICKS];
    scene_tick_t right[SCENE_TICKS];
} scene_t;

/// Draws one. Returns false iff this rig does not come to run within some seconds, or does not stay
/// what it is: draw again.
bool scene_draw(scene_t *self, scene_kind_t kind, dice_t *dice);

#endif
