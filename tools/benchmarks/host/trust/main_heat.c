// A day of rest, of full drive and of bursts on boards at random, beside a coil that is computed in
// double precision: how long it is above its budget of heat. Prints one JSON object.
//
//     heat SEED HOURS    of each kind
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "dice.h"
#include "quiesce.h"

enum { RATE_Hz = 500, BOARD_s = 1200, LONGEST_BURST_s = 60 };

typedef enum { REST, FULL_DRIVE, BURSTS, KINDS } kind_t;

typedef struct {
    quiesce_t controller;
    quiesce_board_t board;
    quiesce_params_t params;
    quiesce_in_t in;
    quiesce_out_t out;
    double current_mA;
    double heat_mA2; ///< the square of the current through its lag
    double peak;     ///< of heat, as a part of the budget
    uint64_t above;  ///< ticks
    uint64_t ticks, running;
    dice_t dice;
} rig_t;

static void draw_damper(quiesce_board_damper_t *damper, dice_t *dice) {
    damper->ceiling_mA = dice_between(dice, 100, 20000);
    damper->continuous_mA = dice_between(dice, (damper->ceiling_mA + 9) / 10, damper->ceiling_mA);
    damper->safe_mA = dice_one_in(dice, 2) ? 0 : dice_between(dice, 0, damper->continuous_mA);
    damper->heat_s = dice_between(dice, 5, dice_one_in(dice, 2) ? 30 : 600);
    damper->measures_current = dice_between(dice, 0, 1);
    damper->coil_lag_us = dice_between(dice, 0, dice_one_in(dice, 4) ? 1000000 : 50000);
}

static void draw(rig_t *rig, kind_t kind) {
    do {
        quiesce_board_default(&rig->board);
        draw_damper(&rig->board.damper[0], &rig->dice);
    } while (!quiesce_board_check(&rig->board, NULL));
    quiesce_params_default(&rig->params);
    rig->params.tick_rate_Hz = RATE_Hz;
    rig->params.max_current_mA = QUIESCE_HIGHEST_CURRENT_mA;
    rig->params.unlock_current_mA = QUIESCE_HIGHEST_CURRENT_mA;
    rig->params.constant_current_mA = QUIESCE_HIGHEST_CURRENT_mA;
    if (dice_one_in(&rig->dice, 2)) {
        rig->params.slew_mA_s = dice_between(&rig->dice, 1000, 100000);
    }
    rig->params.law = kind == REST ? QUIESCE_LAW_PHASE : QUIESCE_LAW_CONSTANT;
}

// The coil that is there: its current follows the command, its heat the square of that.
static void heat(rig_t *rig) {
    const quiesce_board_damper_t *damper = &rig->board.damper[0];
    const double tick_s = 1.0 / RATE_Hz;
    const double lag_s = damper->coil_lag_us * 1e-6;
    const double driven_mA =
        rig->out.damper[0].driver_enable ? rig->out.damper[0].current_cmd_mA : 0;
    const double budget_mA2 = (double)damper->continuous_mA * damper->continuous_mA;
    rig->current_mA += (driven_mA - rig->current_mA) * tick_s / (lag_s + tick_s);
    rig->heat_mA2 += (rig->current_mA * rig->current_mA - rig->heat_mA2) * tick_s / damper->heat_s;
    const double part = rig->heat_mA2 / budget_mA2;
    rig->peak = part > rig->peak ? part : rig->peak;
    rig->above += part > 1.0 ? 1u : 0u;
}

static void step(rig_t *rig, bool enable) {
    rig->in.tick++;
    rig->in.enable = enable;
    rig->in.sensor[0].counts = dice_between(&rig->dice, -40, 40); // its noise
    rig->in.sensor[0].is_fresh = true;
    rig->in.driver[0].is_measured = rig->board.damper[0].measures_current != 0;
    rig->in.driver[0].current_mA = (int32_t)(rig->current_mA + 0.5);
    quiesce_step(&rig->controller, &rig->in, &rig->out);
    rig->ticks++;
    rig->running += rig->out.telemetry.state == QUIESCE_STATE_RUN ||
                            rig->out.telemetry.state == QUIESCE_STATE_DEGRADED
                        ? 1u
                        : 0u;
    heat(rig);
}

static void run_board(rig_t *rig, kind_t kind) {
    uint64_t left = (uint64_t)BOARD_s * RATE_Hz;
    draw(rig, kind);
    rig->in = (quiesce_in_t){0};
    rig->out = (quiesce_out_t){0};
    rig->current_mA = 0;
    // As the controller takes it to be at its start.
    rig->heat_mA2 = 0.5 * rig->board.damper[0].continuous_mA * rig->board.damper[0].continuous_mA;
    if (!quiesce_init_board(&rig->controller, &rig->board, &rig->params)) {
        fprintf(stderr, "heat: a board was refused\n");
        exit(1);
    }
    step(rig, false);
    for (bool is_on = true; left > 0; is_on = !is_on) {
        const uint32_t burst_ms = 1u + dice_below(&rig->dice, LONGEST_BURST_s * 1000u);
        const uint64_t ticks = kind == BURSTS ? burst_ms * (uint64_t)RATE_Hz / 1000u + 1u : left;
        for (uint64_t i = 0; i < ticks && left > 0; i++, left--) {
            step(rig, is_on);
        }
    }
}

int main(int argc, char **argv) {
    static rig_t rig;
    if (argc != 3) {
        fprintf(stderr, "usage: heat SEED HOURS\n");
        return 2;
    }
    const uint64_t seed = strtoull(argv[1], NULL, 10);
    const double hours = strtod(argv[2], NULL);
    for (uint32_t kind = 0; kind < KINDS; kind++) {
        const uint64_t boards = (uint64_t)(hours * 3600.0 / BOARD_s + 0.5);
        for (uint64_t i = 0; i < boards; i++) {
            rig.dice = dice_of(seed * KINDS + kind, i);
            run_board(&rig, (kind_t)kind);
        }
    }
    printf("{\"seed\": %" PRIu64 ", \"ticks\": %" PRIu64 ", \"running\": %" PRIu64, seed, rig.ticks,
           rig.running);
    printf(", \"hours\": %.3f", (double)rig.ticks / RATE_Hz / 3600.0 / KINDS);
    printf(", \"above\": %" PRIu64 ", \"peak\": %.6f}\n", rig.above, rig.peak);
    return 0;
}
