#include "rig.h"

#include <stddef.h>

enum { MAX_SETTINGS = 12 };

static int32_t any_value(dice_t *dice, const quiesce_param_info_t *info) {
    if (info->choice_count > 0) {
        return info->choices[dice_below(dice, info->choice_count)];
    }
    if (info->default_value == 0 || dice_one_in(dice, 3)) {
        return dice_between(dice, info->min, info->max);
    }
    // An eighth to four times the default.
    const int64_t part_q8 = INT64_C(32) << dice_below(dice, 5);
    const int64_t value = info->default_value * (part_q8 + dice_below(dice, 512)) / 256;
    return (int32_t)(value < info->min ? info->min : value > info->max ? info->max : value);
}

void rig_draw_param(quiesce_params_t *params, dice_t *dice) {
    const uint32_t index = dice_below(dice, QUIESCE_PARAM_COUNT);
    (void)quiesce_param_set(params, index, any_value(dice, quiesce_param_info(index)));
}

static void draw_params(quiesce_params_t *params, dice_t *dice) {
    do {
        quiesce_params_default(params);
        params->law = dice_between(dice, QUIESCE_LAW_OFF, QUIESCE_LAW_PHASE);
        params->slew_mA_s = dice_between(dice, 1000, 5000000);
        params->sensor_recover_ticks = dice_between(dice, 1, 100);
        const uint32_t settings = dice_below(dice, MAX_SETTINGS + 1);
        for (uint32_t i = 0; i < settings; i++) {
            rig_draw_param(params, dice);
        }
    } while (!quiesce_params_check(params, NULL));
}

static void draw_sensor(quiesce_board_t *board, uint32_t number, dice_t *dice) {
    quiesce_board_sensor_t *const sensor = &board->sensor[number];
    *sensor = board->sensor[0];
    if (number == 0) {
        return; // the accelerometer that is tracked
    }
    sensor->sense = dice_between(dice, 0, QUIESCE_SENSES - 1);
    const bool is_of_body = quiesce_sense_is_of_body(sensor->sense);
    const int32_t owners = is_of_body ? board->bodies : board->dampers;
    sensor->at = sensor->sense == QUIESCE_SENSE_SUPPLY ? 0 : dice_between(dice, 0, owners - 1);
    sensor->axis = 0;
    sensor->polarity = dice_one_in(dice, 2) ? 1 : -1;
    sensor->stuck_us = 0;
}

static void draw_damper(quiesce_board_t *board, uint32_t number, dice_t *dice) {
    quiesce_board_damper_t *const damper = &board->damper[number];
    *damper = board->damper[0];
    damper->end_a = dice_between(dice, 0, board->bodies - 1);
    damper->end_b = QUIESCE_GROUND;
    damper->ceiling_mA = dice_between(dice, 1, dice_one_in(dice, 2) ? 5000 : 20000);
    damper->safe_mA = dice_one_in(dice, 2) ? 0 : dice_between(dice, 0, damper->ceiling_mA);
    damper->continuous_mA = dice_between(dice, 1, damper->ceiling_mA);
    damper->measures_current = dice_between(dice, 0, 1);
    damper->coil_lag_us = dice_between(dice, 0, 20000);
}

static void draw_board(quiesce_board_t *board, dice_t *dice) {
    do {
        quiesce_board_default(board);
        board->sensors = dice_between(dice, 1, QUIESCE_SENSORS);
        board->bodies = dice_between(dice, 1, QUIESCE_BODIES);
        board->dampers = dice_between(dice, 1, QUIESCE_DAMPERS);
        for (uint32_t i = 0; i < (uint32_t)board->dampers; i++) {
            draw_damper(board, i, dice);
        }
        for (uint32_t i = 0; i < (uint32_t)board->sensors; i++) {
            draw_sensor(board, i, dice);
        }
    } while (!quiesce_board_check(board, NULL));
}

void rig_draw(rig_t *self, dice_t *dice) {
    draw_params(&self->params, dice);
    self->has_board = dice_one_in(dice, 2);
    if (self->has_board) {
        draw_board(&self->board, dice);
    }
}

bool rig_start(const rig_t *self, quiesce_t *controller) {
    return self->has_board ? quiesce_init_board(controller, &self->board, &self->params)
                           : quiesce_init(controller, &self->params);
}

uint32_t rig_dampers(const rig_t *self) {
    return self->has_board ? (uint32_t)self->board.dampers : 1u;
}

static int32_t lesser(int32_t a, int32_t b) {
    return a < b ? a : b;
}

int32_t rig_limit_mA(const rig_t *self, uint32_t damper) {
    const int32_t ceiling_mA =
        self->has_board ? self->board.damper[damper].ceiling_mA : QUIESCE_HIGHEST_CURRENT_mA;
    return lesser(self->params.max_current_mA, ceiling_mA);
}

int32_t rig_safe_mA(const rig_t *self, uint32_t damper) {
    const int32_t safe_mA = self->has_board ? self->board.damper[damper].safe_mA
                                            : quiesce_params_safe_current_mA(&self->params);
    return lesser(safe_mA, rig_limit_mA(self, damper));
}
