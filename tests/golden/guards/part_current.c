// What watches and limits a damper's current. Draws are statements of their own: the order in which
// an expression or an initialiser evaluates its parts is the compiler's.
#include <stddef.h>

#include "coil.h"
#include "current_monitor.h"
#include "drive.h"
#include "energy.h"
#include "guard.h"
#include "heat.h"
#include "part.h"
#include "part_cases.h"

enum { CASES = 24, STEPS = 4000, RESTARTS = 8 };

static uint32_t draw_rate(part_t *part) {
    static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    return rates_Hz[draw_below(&part->seed, 4)];
}

static int32_t draw_sign(part_t *part) {
    return part_one_in(part, 2) ? 1 : -1;
}

static void guard_case(uint32_t number) {
    part_t part;
    guard_t guard;
    part_open(&part, "guard", number);
    for (uint32_t restart = 0; restart < RESTARTS; restart++) {
        guard_cfg_t cfg;
        cfg.max_mA = part_edge(&part, -2, QUIESCE_HIGHEST_CURRENT_mA + 2);
        cfg.safe_mA = part_edge(&part, -2, QUIESCE_HIGHEST_CURRENT_mA + 2);
        cfg.slew_mA_s = part_edge(&part, 1000, part_one_in(&part, 2) ? 100000 : INT32_MAX);
        cfg.tick_rate_Hz = draw_rate(&part);
        guard_init(&guard, &cfg);
        const int32_t a_tick_mA = cfg.slew_mA_s / (int32_t)cfg.tick_rate_Hz;
        const int32_t slew_mA = a_tick_mA < 40000 ? a_tick_mA : 40000;
        for (uint32_t i = 0; i < STEPS / RESTARTS; i++) {
            const int32_t step_mA = draw_sign(&part) * slew_mA;
            const int32_t base_mA = guard.last_uA / 1000 + (part_one_in(&part, 2) ? step_mA : 0);
            const int32_t request_mA = part_one_in(&part, 3)
                                           ? part_edge(&part, INT32_MIN, INT32_MAX)
                                           : part_near(&part, base_mA);
            const bool is_allowed = !part_one_in(&part, 30);
            part_word(&part, guard_step(&guard, request_mA, is_allowed));
            part_word(&part, guard.last_uA);
        }
    }
    part_close(&part);
}

static int32_t draw_measured(part_t *part, int32_t expected_mA, int32_t error_mA, int32_t trip_mA) {
    const int32_t sign = draw_sign(part);
    switch (draw_below(&part->seed, 8)) {
    case 0:
        return part_near(part, expected_mA + (int64_t)sign * error_mA);
    case 1:
        return part_near(part, sign * (int64_t)trip_mA);
    case 2:
        return part_near(part, 0);
    case 3:
        return part_near(part, sign * (int64_t)error_mA);
    case 4:
        return part_edge(part, INT32_MIN, INT32_MAX);
    default:
        return part_near(part, expected_mA);
    }
}

static uint16_t as_command(int32_t current_mA) {
    const int32_t least_mA = current_mA > 0 ? current_mA : 0;
    return (uint16_t)(least_mA < CURRENT_MOST_mA ? least_mA : CURRENT_MOST_mA);
}

static void monitor_case(uint32_t number) {
    part_t part;
    current_monitor_t monitor;
    part_open(&part, "monitor", number);
    for (uint32_t restart = 0; restart < RESTARTS; restart++) {
        current_monitor_cfg_t cfg;
        cfg.check = (current_check_t)draw_below(&part.seed, 3);
        cfg.tick_rate_Hz = draw_rate(&part);
        cfg.error_mA = part_edge(&part, 1, 400);
        cfg.lag_us = part_edge(&part, 0, 50000);
        cfg.fault_ticks = (uint32_t)part_edge(&part, 1, 60);
        cfg.trip_mA = part_one_in(&part, 2) ? 0 : part_edge(&part, 1, 6000);
        cfg.trip_ticks = (uint32_t)part_edge(&part, 1, 40);
        int32_t command_mA = part_edge(&part, 0, 5000);
        uint32_t wrong_in = 1;
        uint32_t missing_in = 20;
        current_monitor_init(&monitor, &cfg);
        current_monitor_follow(&monitor, command_mA);
        for (uint32_t i = 0; i < STEPS / RESTARTS; i++) {
            const int32_t expected_mA = current_monitor_expected_mA(&monitor);
            command_mA = part_one_in(&part, 60) ? part_edge(&part, 0, 5000) : command_mA;
            wrong_in = part_one_in(&part, 40) ? 1u + draw_below(&part.seed, 12) : wrong_in;
            const int32_t measured_mA =
                part_one_in(&part, wrong_in)
                    ? draw_measured(&part, expected_mA, cfg.error_mA, cfg.trip_mA)
                    : expected_mA;
            missing_in = part_one_in(&part, 40) ? 1u + draw_below(&part.seed, 20) : missing_in;
            const current_measured_t measured = part_one_in(&part, missing_in) ? CURRENT_NONE
                                                : part_one_in(&part, 3)        ? CURRENT_OLD
                                                                               : CURRENT_NEW;
            part_word(&part, current_monitor_step(&monitor, as_command(command_mA), measured_mA,
                                                  measured));
            part_word(&part, current_monitor_expected_mA(&monitor));
            part_word(&part, current_monitor_is_quiet(&monitor));
            if (part_one_in(&part, 50)) {
                current_monitor_reset(&monitor);
            }
        }
    }
    part_close(&part);
}

static void coil_case(uint32_t number) {
    part_t part;
    coil_t coil;
    part_open(&part, "coil", number);
    for (uint32_t restart = 0; restart < RESTARTS; restart++) {
        const int32_t resistance_mohm = part_edge(&part, 0, part_one_in(&part, 2) ? 4 : 100000);
        const int32_t error_mA = part_edge(&part, 1, 400);
        uint32_t short_in = 1;
        const uint32_t fault_ticks = (uint32_t)part_edge(&part, 1, 60);
        coil_init(&coil, resistance_mohm, error_mA, fault_ticks);
        for (uint32_t i = 0; i < STEPS / RESTARTS; i++) {
            const int32_t command_mA =
                part_one_in(&part, 3) ? part_near(&part, 2 * error_mA) : part_edge(&part, 0, 5000);
            const int32_t sign = draw_sign(&part);
            const int32_t current_mA = part_one_in(&part, 3)
                                           ? part_near(&part, command_mA + sign * error_mA)
                                           : part_near(&part, command_mA);
            const int64_t quarter_mV = (int64_t)current_mA * resistance_mohm / 4000;
            short_in = part_one_in(&part, 50) ? 1u + draw_below(&part.seed, 6) : short_in;
            const int32_t voltage_mV = part_one_in(&part, short_in)
                                           ? part_near(&part, sign * quarter_mV)
                                           : part_near(&part, 4 * quarter_mV);
            part_word(&part, coil_is_short(&coil, command_mA, current_mA, voltage_mV));
            const int32_t half_mV = part_near(&part, sign * 2 * quarter_mV);
            part_word(&part, coil_is_open(&coil, command_mA, half_mV));
        }
    }
    part_close(&part);
}

static void energy_case(uint32_t number) {
    enum { RUN_TICKS = 12 * 500 }; // three times as long as it takes
    part_t part;
    energy_t energy;
    part_open(&part, "energy", number);
    energy_init(&energy, (uint32_t)part_near(&part, part_one_in(&part, 2) ? 500 : 512));
    const int32_t most_bits = 1 + (int32_t)draw_below(&part.seed, 29);
    int32_t polarity = part_one_in(&part, 3) ? 1 : -1;
    for (uint32_t i = 0; i < 3u * RUN_TICKS; i++) {
        const int32_t most = (int32_t)((1u << most_bits) - 1u);
        const int32_t velocity_um_s = part_edge(&part, -most, most);
        const int32_t size_mN = part_edge(&part, -most / 4, most);
        const int32_t force_mN = (velocity_um_s < 0 ? -polarity : polarity) * size_mN;
        const bool are_valid = !part_one_in(&part, 2000);
        part_word(&part, energy_is_negative(&energy, force_mN, velocity_um_s, are_valid));
        if (part_one_in(&part, 5000)) {
            energy_forget(&energy);
        }
        polarity = part_one_in(&part, 3000) ? -polarity : polarity;
    }
    part_close(&part);
}

static int32_t most_of(int32_t continuous_mA) {
    const int64_t ten_mA = 10 * (int64_t)continuous_mA;
    return ten_mA < QUIESCE_HIGHEST_CURRENT_mA ? (int32_t)ten_mA : QUIESCE_HIGHEST_CURRENT_mA;
}

static void heat_case(uint32_t number) {
    part_t part;
    heat_t heat;
    part_open(&part, "heat", number);
    for (uint32_t restart = 0; restart < RESTARTS; restart++) {
        heat_cfg_t cfg;
        cfg.tick_rate_Hz = draw_rate(&part);
        cfg.continuous_mA = part_edge(&part, 1, QUIESCE_HIGHEST_CURRENT_mA);
        cfg.highest_mA = part_edge(&part, 0, most_of(cfg.continuous_mA));
        cfg.time_s = part_edge(&part, 5, part_one_in(&part, 2) ? 6 : 10000);
        cfg.settle_us = (uint32_t)part_edge(&part, 0, part_one_in(&part, 2) ? 5000 : 100000000);
        cfg.first_ticks = 1u + draw_below(&part.seed, HEAT_SLICE_TICKS);
        heat_init(&heat, &cfg);
        for (uint32_t i = 0; i < STEPS / RESTARTS; i++) {
            if (part_one_in(&part, 50)) { // to an edge, which would take long
                const int64_t line_q20 = (int64_t)heat.line << heat.shift;
                const int64_t budget_q20 = heat_budget_q20(&heat);
                const int64_t over_q20 = budget_q20 / 16 + (3 << 20);
                const int64_t left_q20[] = {line_q20, 0, -over_q20, line_q20 / 2, -budget_q20};
                const int64_t at_q20 = budget_q20 - left_q20[draw_below(&part.seed, 5)];
                heat_resume(&heat, at_q20 + part_near(&part, 0));
            }
            part_word(&part, heat_limit_mA(&heat));
            part_word(&part, heat_is_limiting(&heat));
            part_word(&part, heat_is_excessive(&heat));
            heat_step(&heat, part_one_in(&part, 9) ? part_edge(&part, INT32_MIN, INT32_MAX)
                                                   : part_near(&part, cfg.continuous_mA));
            part_word(&part, heat.heat_q20);
        }
    }
    part_close(&part);
}

static void draw_damper(part_t *part, quiesce_board_t *board) {
    do {
        quiesce_board_default(board);
        quiesce_board_damper_t *const damper = &board->damper[0];
        damper->ceiling_mA =
            part_edge(part, 2, part_one_in(part, 3) ? 6 : QUIESCE_HIGHEST_CURRENT_mA);
        damper->continuous_mA =
            draw_between(&part->seed, (damper->ceiling_mA + 9) / 10, damper->ceiling_mA);
        damper->safe_mA = part_edge(part, 0, damper->continuous_mA);
        damper->heat_s = part_one_in(part, 2) ? 5 : part_edge(part, 5, 10000);
        damper->coil_lag_us = part_edge(part, 0, 50000);
        damper->measures_current = part_one_in(part, 4) ? 0 : 1;
        damper->trip_mA = part_one_in(part, 2) || damper->measures_current == 0
                              ? 0
                              : damper->ceiling_mA + part_edge(part, 1, 2000);
        damper->trip_us = part_edge(part, 100, 20000);
        damper->coil_mohm = 0;
    } while (!quiesce_board_check(board, NULL));
    // Its sensor is the caller's matter.
    board->damper[0].coil_mohm = part_one_in(part, 2) ? 0 : part_edge(part, 1, 20000);
}

static void draw_params(part_t *part, quiesce_params_t *params) {
    do {
        quiesce_params_default(params);
        params->tick_rate_Hz = (int32_t)draw_rate(part);
        params->max_current_mA = part_edge(part, 1, QUIESCE_HIGHEST_CURRENT_mA);
        params->current_error_mA = part_edge(part, 1, 1000);
        params->current_fault_ticks = part_edge(part, 1, 60);
        params->slew_mA_s = part_edge(part, 1000, 5000000);
    } while (!quiesce_params_check(params, NULL));
}

static void drive_tick(part_t *part, drive_t *drive, int32_t resistance_mohm, uint32_t wrong_in) {
    const int32_t expected_mA = current_monitor_expected_mA(&drive->monitor);
    const bool is_wrong = part_one_in(part, wrong_in);
    quiesce_driver_t driver = {.current_mA = expected_mA};
    if (is_wrong) {
        driver.current_mA =
            draw_measured(part, expected_mA, drive->monitor.error_mA, drive->monitor.trip_mA);
    }
    driver.is_measured = !part_one_in(part, 50);
    const int64_t voltage_mV = (int64_t)driver.current_mA * resistance_mohm / 1000;
    const bool is_short = is_wrong || part_one_in(part, 2 * wrong_in);
    const int32_t across_mV = part_near(part, is_short ? voltage_mV / 8 : voltage_mV);
    const bool is_known = resistance_mohm > 0 && !part_one_in(part, 20);
    const int32_t request_mA = part_edge(part, -10, 2 * QUIESCE_HIGHEST_CURRENT_mA);
    const bool is_allowed = !part_one_in(part, 40);
    const bool driver_enable = !part_one_in(part, 40);
    current_verdict_t verdict;
    quiesce_command_t command;
    part_word(part, drive_watch(drive, &driver, is_known ? &across_mV : NULL, &verdict));
    part_word(part, verdict);
    part_word(part, drive_is_intact(drive));
    if (part_one_in(part, 300)) { // its guard is not what it was
        drive->limits.guard.safe_mA = part_edge(part, -9, 2 * QUIESCE_HIGHEST_CURRENT_mA);
        drive->limits.guard.max_mA = part_edge(part, -9, 2 * QUIESCE_HIGHEST_CURRENT_mA);
        part_word(part, drive_is_intact(drive));
    }
    if (part_one_in(part, 400)) {
        drive_shut(drive, &command);
    } else {
        drive_command(drive, request_mA, is_allowed, driver_enable, &command);
    }
    part_word(part, command.current_cmd_mA);
    part_word(part, command.driver_enable);
    part_word(part, drive_current_cmd_mA(drive));
    part_word(part, drive_is_limited(drive));
    part_word(part, energy_is_negative(&drive->energy, -request_mA, request_mA, true));
    if (part_one_in(part, 200)) {
        drive_forget(drive);
    }
    if (part_one_in(part, 100)) { // near its end, which would take long
        drive->energy.ticks = (4u << drive->energy.shift) - 3u;
    }
    if (part_one_in(part, 200)) { // near its budget, which would take long
        const int64_t budget_q20 = heat_budget_q20(&drive->heat);
        heat_resume(&drive->heat, budget_q20 - budget_q20 / 20);
    }
}

static void drive_case(uint32_t number) {
    part_t part;
    part_open(&part, "drive", number);
    for (uint32_t restart = 0; restart < RESTARTS; restart++) {
        quiesce_board_t board;
        quiesce_params_t params;
        drive_t drive;
        uint32_t wrong_in = 4;
        draw_damper(&part, &board);
        draw_params(&part, &params);
        const bool is_accepted = !part_one_in(&part, 8);
        if (!is_accepted) {
            params.current_error_mA = part_near(&part, 0);
            params.slew_mA_s = part_edge(&part, INT32_MIN, INT32_MAX);
            params.max_current_mA = part_edge(&part, INT32_MIN, INT32_MAX);
        }
        drive_init(&drive, restart % QUIESCE_DAMPERS, &board.damper[0], &params, is_accepted);
        part_word(&part, (int64_t)drive.heat.line << drive.heat.shift);
        part_word(&part, drive.monitor.over_limit);
        for (uint32_t i = 0; i < STEPS / RESTARTS; i++) {
            wrong_in = part_one_in(&part, 80) ? 1u + draw_below(&part.seed, 100) : wrong_in;
            drive_tick(&part, &drive, board.damper[0].coil_mohm, wrong_in);
        }
    }
    part_close(&part);
}

void part_current_cases(void) {
    for (uint32_t number = 0; number < CASES; number++) {
        guard_case(number);
        monitor_case(number);
        coil_case(number);
        energy_case(number);
        heat_case(number);
        drive_case(number);
    }
}
