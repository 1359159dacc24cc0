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
#include "print.h"
#include "table_feed.h"
#include "table_rig.h"

#include <stddef.h>

enum { IDLE, TRANSFER, COMMIT, USED, FETCH, MINUTE };
enum { MINUTE_TICKS = 60000, AROUND_ticks = 10, MOST_ANSWER_ticks = 1000, FETCH_MORE_ticks = 50 };

static void tick(rig_t *rig, bool is_counted) {
    rig_prepare(rig);
    if (is_counted) {
        counted_call((counted_function_t)rig_tick, (uintptr_t)rig, 0, 0);
    } else {
        rig_tick(rig);
    }
    rig_pass(rig);
}

static void run(rig_t *rig, uint32_t ticks, bool is_counted) {
    for (uint32_t i = 0; i < ticks; i++) {
        tick(rig, is_counted);
    }
}

static void transfer(rig_t *rig, const uint32_t *words, bool is_counted) {
    table_feed_t feed;
    can_frame_t frame;
    table_feed_begin(&feed, words, rig_count(words));
    while (table_feed_next(&feed, &frame)) {
        rig_hear(rig, &frame);
        tick(rig, is_counted);
        tick(rig, is_counted);
    }
}

// Runs until the answer.
static void ask(rig_t *rig, uint8_t operation, uint8_t road, uint32_t value, bool is_counted) {
    struct quiesce_can_service_reply_t reply = {.result = UINT8_MAX};
    const can_frame_t request = make_request(operation, road, (int32_t)value, 1);
    rig_hear(rig, &request);
    for (uint32_t i = 0; i < MOST_ANSWER_ticks; i++) {
        tick(rig, is_counted);
        const can_frame_t *frame = rig_sent(rig, QUIESCE_CAN_SERVICE_REPLY_FRAME_ID);
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
static void fetch(rig_t *rig, const uint32_t *words, bool is_counted) {
    const can_frame_t flow = {
        .id = QUIESCE_CAN_TABLE_DATA_FRAME_ID, .length = ISOTP_FRAME_BYTES, .data = {0x30, 0, 2}};
    ask(rig, QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SEND_CHOICE, rig_road(words), 0,
        is_counted);
    tick(rig, is_counted);
    rig_hear(rig, &flow);
    run(rig, rig_count(words) + FETCH_MORE_ticks, is_counted);
}

static void run_parts(rig_t *rig, const rig_order_t *order, const uint32_t *words) {
    const uint32_t part = order->part;
    run(rig, RIG_SETTLED_ticks, false);
    run(rig, order->ticks, part == IDLE);
    if (part == MINUTE) {
        run(rig, MINUTE_TICKS - AROUND_ticks - rig->number, false);
        run(rig, 2u * AROUND_ticks, true);
    }
    if (part == IDLE || part == MINUTE) {
        return;
    }
    transfer(rig, words, part == TRANSFER);
    ask(rig, QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_COMMIT_CHOICE, 0, rig_crc(words),
        part == COMMIT);
    run(rig, order->ticks, part == USED);
    fetch(rig, words, part == FETCH);
}

int main(void) {
    static rig_t rig;
    const rig_order_t *order = (const rig_order_t *)MAILBOX_BASE;
    if (!rig_start(&rig, order, order->tables - 1u)) {
        return 1;
    }
    counted_call_init();
    run_parts(&rig, order, rig_table(order, order->tables - 1u));
    print("state", rig.node.out.telemetry.state);
    return 0;
}
