// A controller under rules that a test exchanges, and the current that they say at rest.
#ifndef RULES_RIG_H
#define RULES_RIG_H

#include "quiesce.h"
#include "table_samples.h"
#include "unity.h"

static quiesce_t controller;
static uint32_t ticks;

// A good table whose current at rest is its origin, which the shipped rules (0 mA) do not give.
static uint32_t table[QUIESCE_TABLE_WORDS + 1u];
static uint32_t count;

static void start(void) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    TEST_ASSERT_TRUE(quiesce_init(&controller, &params));
    ticks = 0;
}

static quiesce_out_t step(void) {
    const quiesce_in_t in = {.tick = ticks, .sensor[0].is_fresh = true, .enable = ticks > 0};
    quiesce_out_t out;
    ticks++;
    quiesce_step(&controller, &in, &out);
    return out;
}

// What the law reports of its rules.
static int32_t rules_mA(void) {
    int32_t report[QUIESCE_REPORT_WORDS];
    quiesce_report(&controller, report);
    return report[0];
}

// One more tick; the rules' current in it.
static int32_t next_mA(void) {
    (void)step();
    return rules_mA();
}

static void make_table(int32_t at_rest_mA) {
    count = sample_rules(table, at_rest_mA);
}

#endif
