/// Inputs of a controller in a storm: sensors, coils, an operator and drivers that do everything
/// wrong, alone and on top of each other, between stretches that are calm enough to run.
#ifndef STORM_H
#define STORM_H

#include "dice.h"
#include "quiesce.h"
#include "rig.h"

typedef enum { SENSE_GOOD, SENSE_LOST, SENSE_FULL, SENSE_WILD, SENSE_STUCK, SENSE_PATCHY } sense_t;
typedef enum { COIL_FOLLOWS, COIL_OPEN, COIL_OFF_BY, COIL_WILD, COIL_UNKNOWN } coil_t;

typedef struct {
    uint32_t left_ticks;
    uint32_t kind;
} spell_t;

typedef struct {
    dice_t *dice;
    const rig_t *rig;
    uint32_t calm; ///< how many times rarer than in the worst storm all of it is
    spell_t sense[QUIESCE_SENSORS], coil[QUIESCE_DAMPERS];
    spell_t estop, failed, enable, reset;
    uint32_t failed_damper;
    int32_t off_by_mA;
    int32_t coil_mA_q8[QUIESCE_DAMPERS];
    uint32_t phase_turn, step_turn;
    int32_t amplitude;
} storm_t;

void storm_start(storm_t *self, const rig_t *rig, dice_t *dice);

/// The next tick's input; out: what the last one left. *in is the last input.
void storm_tick(storm_t *self, const quiesce_out_t *out, quiesce_in_t *in);

#endif
