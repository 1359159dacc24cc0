#include "table_rig.h"

#include "can_make.h"
#include "print.h"
#include "test_signal.h"

#include <stddef.h>

#define RATE_Hz 1000u
#define COUNTS 40000
#define NOISE_COUNTS 50
#define CRC_WORD 1u
#define COUNT_WORD 2u

_Static_assert(sizeof(quiesce_params_t) == QUIESCE_PARAM_COUNT * sizeof(uint32_t), "a word each");

static keeper_answer_t store(void *context, keeper_record_t record, const uint32_t *words,
                             uint32_t count) {
    (void)context;
    (void)record;
    (void)words;
    (void)count;
    return KEEPER_DONE;
}

uint32_t rig_count(const uint32_t *words) {
    return words[COUNT_WORD];
}

uint32_t rig_crc(const uint32_t *words) {
    return words[CRC_WORD];
}

uint8_t rig_road(const uint32_t *words) {
    quiesce_owner_t owner = QUIESCE_OF_LAW;
    (void)quiesce_table_kind(words[0], &owner);
    return words[0] == TABLE_FILE_LEARNT ? (uint8_t)ROAD_LEARNT : (uint8_t)owner;
}

const uint32_t *rig_table(const rig_order_t *order, uint32_t number) {
    const uint32_t *words = order->words;
    for (uint32_t i = 0; i < number; i++) {
        words += rig_count(words);
    }
    return words;
}

static uint32_t use_tables(rig_t *rig, const rig_order_t *order, uint32_t used) {
    uint32_t refused = 0;
    for (uint32_t i = 0; i < used; i++) {
        const uint32_t *words = rig_table(order, i);
        const table_found_t found = {(keeper_record_t)(KEEPER_LAW_TABLE + rig_road(words)),
                                     TABLE_FROM_CONFIG, words, rig_count(words), 0};
        refused += node_found(&rig->node, &found) != QUIESCE_TABLE_OK ? 1u : 0u;
    }
    return refused;
}

bool rig_start(rig_t *rig, const rig_order_t *order, uint32_t used) {
    static const node_sources_t sources = {.enable = NODE_ENABLE_BOARD, .sensors_on_bus = 1};
    const quiesce_params_t *params = (const quiesce_params_t *)(const void *)order->params;
    rig->board = (node_inputs_t){.ticks_elapsed = 1};
    if (!node_init(&rig->node, NULL, params, sources)) {
        return false;
    }
    node_use_store(&rig->node, store, NULL);
    print("refused", use_tables(rig, order, used));
    return true;
}

void rig_hear(rig_t *rig, const can_frame_t *frame) {
    rig->heard[rig->heard_count] = *frame;
    rig->heard_count++;
}

void rig_prepare(rig_t *rig) {
    const uint32_t freq_mHz = 1000u * RATE_Hz / RIG_PERIOD_ticks;
    const int32_t counts = signal_sine(COUNTS, freq_mHz, rig->number, RATE_Hz);
    const can_frame_t sample = make_accel(counts + signal_noise(&rig->noise, NOISE_COUNTS), false,
                                          false, (uint8_t)(rig->number % 16u));
    rig_hear(rig, &sample);
    rig->board.enable = rig->number > RIG_SETTLED_ticks / 2; // its edge arms
}

void rig_tick(rig_t *rig) {
    for (uint32_t i = 0; i < rig->heard_count; i++) {
        node_receive(&rig->node, &rig->heard[i]);
    }
    rig->sent = node_tick(&rig->node, &rig->board, rig->frames);
}

void rig_pass(rig_t *rig) {
    rig->number++;
    rig->heard_count = 0;
}

const can_frame_t *rig_sent(const rig_t *rig, uint32_t id) {
    for (uint32_t i = 0; i < rig->sent; i++) {
        if (rig->frames[i].id == id) {
            return &rig->frames[i];
        }
    }
    return NULL;
}
