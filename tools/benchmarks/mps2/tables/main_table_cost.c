// What tables on the bus cost a node's tick, in instructions. A tick, with what is received for it,
// is counted in the part that the order names:
//
//   IDLE      nothing is transferred
//   TRANSFER  the last table of the order comes, a frame in two ticks
//   COMMIT    from the request until its answer
//   USED      afterwards
//   FETCH     it goes back to the host
//   MINUTE    a minute after the start, where what was learnt is stored
//
// The tables before the last one are in use from the start.
#include "can_make.h"
#include "counted_call.h"
#include "mailbox.h"
#include "node.h"
#include "print.h"
#include "table_feed.h"
#include "test_signal.h"

#include <stddef.h>

enum { IDLE, TRANSFER, COMMIT, USED, FETCH, MINUTE };
enum { MOST_HEARD = 3, MINUTE_TICKS = 60000, AROUND_ticks = 10, MOST_ANSWER_ticks = 1000 };
enum {
    RATE_Hz = 1000,
    FREQ_mHz = 10000,
    COUNTS = 40000,
    OPERATOR_ticks = 100,
    SETTLED_ticks = 2500
};

#define CRC_WORD 1u
#define COUNT_WORD 2u

typedef struct {
    uint32_t part;
    uint32_t ticks; ///< of IDLE and USED
    uint32_t law;
    uint32_t tracker;
    uint32_t tables;
    uint32_t words[]; ///< of all tables, one after the other
} order_t;

typedef struct {
    node_t node;
    node_inputs_t board;
    can_frame_t frames[NODE_MAX_FRAMES];
    uint32_t sent;
    can_frame_t heard[MOST_HEARD];
    uint32_t heard_count;
    uint32_t number; ///< of the tick
    uint32_t noise;
} rig_t;

static keeper_answer_t store(void *context, keeper_record_t record, const uint32_t *words,
                             uint32_t count) {
    (void)context;
    (void)record;
    (void)words;
    (void)count;
    return KEEPER_DONE;
}

static void hear(rig_t *rig, can_frame_t frame) {
    rig->heard[rig->heard_count] = frame;
    rig->heard_count++;
}

static void run_tick(rig_t *rig) {
    for (uint32_t i = 0; i < rig->heard_count; i++) {
        node_receive(&rig->node, &rig->heard[i]);
    }
    rig->sent = node_tick(&rig->node, &rig->board, rig->frames);
}

static void tick(rig_t *rig, bool is_counted) {
    const uint8_t alive = (uint8_t)(rig->number % 16u);
    const int32_t counts = signal_sine(COUNTS, FREQ_mHz, rig->number, RATE_Hz);
    hear(rig, make_accel(counts + signal_noise(&rig->noise, 50), false, false, alive));
    rig->board.enable = rig->number > SETTLED_ticks / 2; // its edge arms
    if (is_counted) {
        counted_call((counted_function_t)run_tick, (uintptr_t)rig, 0, 0);
    } else {
        run_tick(rig);
    }
    rig->number++;
    rig->heard_count = 0;
}

static void run(rig_t *rig, uint32_t ticks, bool is_counted) {
    for (uint32_t i = 0; i < ticks; i++) {
        tick(rig, is_counted);
    }
}

static void transfer(rig_t *rig, const uint32_t *words, bool is_counted) {
    table_feed_t feed;
    can_frame_t frame;
    table_feed_begin(&feed, words, words[COUNT_WORD]);
    while (table_feed_next(&feed, &frame)) {
        hear(rig, frame);
        tick(rig, is_counted);
        tick(rig, is_counted);
    }
}

// The frame of this id among those that were sent; NULL: none.
static const can_frame_t *sent_frame(const rig_t *rig, uint32_t id) {
    for (uint32_t i = 0; i < rig->sent; i++) {
        if (rig->frames[i].id == id) {
            return &rig->frames[i];
        }
    }
    return NULL;
}

// Runs until the answer.
static void ask(rig_t *rig, uint8_t operation, uint8_t road, uint32_t value, bool is_counted) {
    struct quiesce_can_service_reply_t reply = {.result = UINT8_MAX};
    hear(rig, make_request(operation, road, (int32_t)value, 1));
    for (uint32_t i = 0; i < MOST_ANSWER_ticks; i++) {
        tick(rig, is_counted);
        const can_frame_t *frame = sent_frame(rig, QUIESCE_CAN_SERVICE_REPLY_FRAME_ID);
        if (frame != NULL) {
            (void)quiesce_can_service_reply_unpack(&reply, frame->data, frame->length);
            break;
        }
    }
    if (operation == QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_COMMIT_CHOICE) {
        print("result", reply.result);
        print("verdict", (uint32_t)reply.param_value);
    }
}

// The host's flow control lets all of it go.
static void fetch(rig_t *rig, uint8_t road, const uint32_t *words, bool is_counted) {
    can_frame_t flow = {
        .id = QUIESCE_CAN_TABLE_DATA_FRAME_ID, .length = ISOTP_FRAME_BYTES, .data = {0x30, 0, 2}};
    ask(rig, QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SEND_CHOICE, road, 0, is_counted);
    tick(rig, is_counted);
    hear(rig, flow);
    run(rig, words[COUNT_WORD] + 50u, is_counted);
}

static uint8_t road_of(const uint32_t *words) {
    quiesce_owner_t owner = QUIESCE_OF_LAW;
    (void)quiesce_table_kind(words[0], &owner);
    return words[0] == TABLE_FILE_LEARNT ? (uint8_t)ROAD_LEARNT : (uint8_t)owner;
}

// Tables of the start; returns the last one of the order.
static const uint32_t *start(rig_t *rig, const order_t *order) {
    const uint32_t *words = order->words;
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = (int32_t)order->law;
    params.tracker = (int32_t)order->tracker;
    rig->board = (node_inputs_t){.ticks_elapsed = 1};
    if (!node_init(&rig->node, NULL, &params,
                   (node_sources_t){.enable = NODE_ENABLE_BOARD, .sensors_on_bus = 1})) {
        return NULL;
    }
    node_use_store(&rig->node, store, NULL);
    uint32_t refused = 0;
    for (uint32_t i = 0; i + 1u < order->tables; i++) {
        const table_found_t found = {(keeper_record_t)(KEEPER_LAW_TABLE + road_of(words)),
                                     TABLE_FROM_CONFIG, words, words[COUNT_WORD], 0};
        refused |= (uint32_t)node_found(&rig->node, &found);
        words += words[COUNT_WORD];
    }
    print("refused", refused);
    return words;
}

static void run_parts(rig_t *rig, const order_t *order, const uint32_t *words) {
    const uint32_t part = order->part;
    run(rig, SETTLED_ticks, false);
    run(rig, order->ticks, part == IDLE);
    if (part == MINUTE) {
        run(rig, MINUTE_TICKS - AROUND_ticks - rig->number, false);
        run(rig, 2u * AROUND_ticks, true);
    }
    if (part == IDLE || part == MINUTE) {
        return;
    }
    transfer(rig, words, part == TRANSFER);
    ask(rig, QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_COMMIT_CHOICE, 0, words[CRC_WORD],
        part == COMMIT);
    run(rig, order->ticks, part == USED);
    fetch(rig, road_of(words), words, part == FETCH);
}

int main(void) {
    static rig_t rig;
    const order_t *order = (const order_t *)MAILBOX_BASE;
    const uint32_t *words = start(&rig, order);
    if (words == NULL) {
        return 1;
    }
    counted_call_init();
    run_parts(&rig, order, words);
    print("state", rig.node.out.telemetry.state);
    return 0;
}
