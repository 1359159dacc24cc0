// Prints, as SLCAN lines, what a controller sends in some seconds with every word of its telemetry
// at an end of its range, then at random: the Python test decodes all of it.
#include "can_make.h"
#include "can_node.h"
#include "slcan.h"
#include "table_link.h"

#include <stdio.h>

#define TICKS 2100u

static can_node_t node;
static quiesce_out_t out;
static can_node_tick_t tick;
static quiesce_t controller;

static uint32_t next_random(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed ^ *seed >> 13;
}

static void fill(uint32_t words[], uint32_t count, const int32_t *value, uint32_t *seed) {
    for (uint32_t i = 0; i < count; i++) {
        words[i] = value != NULL ? (uint32_t)*value : next_random(seed);
    }
}

// value: of every word, or NULL for random ones.
static void fill_all(const int32_t *value, uint32_t *seed) {
    uint32_t other[8];
    fill((uint32_t *)(void *)&out.telemetry, sizeof out.telemetry / 4u, value, seed);
    fill(other, 8, value, seed);
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        out.damper[i].current_cmd_mA = (int32_t)other[i];
        out.damper[i].driver_enable = (other[i] & 1u) != 0;
    }
    tick = (can_node_tick_t){
        .enable = (other[0] & 2u) != 0,
        .estop = (other[0] & 4u) != 0,
        .accel_counts = (int32_t)other[1],
        .accel_is_fresh = (other[0] & 8u) != 0,
        .current_meas_mA = (int32_t)other[2],
        .current_is_measured = (other[0] & 16u) != 0,
        .overruns = other[3],
        .lateness_us = other[4],
        .work_us = other[5],
        .cycles = {other[3], other[4], other[5]},
        .unsent = {other[6], other[6], other[6]},
        .bus_off_count = other[7],
        .ticks = 1,
    };
    fill((uint32_t *)(void *)&node.receive.counters, 5, value, seed);
}

static void print_frame(const can_frame_t *frame) {
    uint8_t text[SLCAN_MAX_BYTES];
    const size_t length = slcan_encode(frame, text);
    printf("%.*s\n", (int)length - 1, (const char *)text);
}

// Raw samples for a second, the whole record; anything else.
static int32_t value_of(uint8_t operation, uint32_t *seed) {
    switch (operation) {
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_RAW_STREAM_CHOICE:
        return 1;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_FAULT_RECORD_CHOICE:
        return 0;
    default:
        return (int32_t)next_random(seed);
    }
}

static void run(const int32_t *value, uint32_t *seed) {
    can_frame_t frames[CAN_NODE_MAX_FRAMES];
    for (uint32_t i = 0; i < TICKS; i++) {
        if (i % 7u == 0) {
            const can_frame_t request =
                make_request((uint8_t)(i % 11u), (uint8_t)next_random(seed),
                             value_of((uint8_t)(i % 11u), seed), (uint8_t)i);
            can_node_receive(&node, &request);
        }
        can_node_answer(&node, (can_node_result_t)(i % 9u), next_random(seed));
        fill_all(value, seed);
        const uint32_t count = can_node_tick(&node, &tick, &out, &controller, frames);
        for (uint32_t k = 0; k < count; k++) {
            print_frame(&frames[k]);
        }
    }
}

// The first frame of a table that goes; for the next ones the other side would have to answer.
static void print_table(uint32_t *seed) {
    static quiesce_tables_t tables;
    table_link_t link = {0};
    can_frame_t frame;
    uint32_t words[16];
    fill(words, 16, NULL, seed);
    words[2] = 16;
    (void)table_link_send(&link, words, 0);
    if (table_link_tick(&link, 1, &tables, &frame)) {
        print_frame(&frame);
    }
}

int main(void) {
    static const int32_t ends[] = {INT32_MIN, -1, 0, 1, INT32_MAX};
    quiesce_params_t params;
    quiesce_board_t board;
    uint32_t seed = 1;
    quiesce_params_default(&params);
    quiesce_board_default(&board);
    board.dampers = QUIESCE_DAMPERS;
    for (uint32_t i = 1; i < QUIESCE_DAMPERS; i++) {
        board.damper[i] = board.damper[0];
    }
    can_node_init(&node, &board, &params);
    (void)quiesce_init(&controller, &params);
    for (uint32_t i = 0; i < sizeof ends / sizeof ends[0]; i++) {
        run(&ends[i], &seed);
    }
    run(NULL, &seed);
    print_table(&seed);
    return 0;
}
