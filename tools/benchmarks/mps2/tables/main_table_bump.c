// The command at the moment at which an armed controller takes another table: the largest step from
// tick to tick over changes at many phases of the motion. The last table of the order and the one
// before it on its road are used by turns; `part` is the number of changes, a phase each, and every
// fourth one takes the table before back, every eighth one takes what ships.
#include "can_make.h"
#include "counted_call.h"
#include "mailbox.h"
#include "print.h"
#include "table_feed.h"
#include "table_rig.h"

#include <stddef.h>

enum { MOST_ANSWER_ticks = 1000, PHASE_STEP_ticks = 37, WAYS = 8, REVERT_WAY = 3, SHIP_WAY = 7 };

typedef struct {
    rig_t rig;
    int32_t last_mA;
    uint32_t largest_step_mA;
    uint32_t done;      ///< requests that were answered so
    uint32_t not_run;   ///< ticks in which it did not
    int32_t largest_mA; ///< since the last look at it
    int32_t least_mA;   ///< of these
    int32_t most_mA;
} watch_t;

static bool runs(const rig_t *rig) {
    const uint32_t state = rig->node.out.telemetry.state;
    return state == QUIESCE_STATE_RUN || state == QUIESCE_STATE_DEGRADED;
}

static void look(watch_t *watch) {
    const int32_t now_mA = watch->rig.node.out.damper[0].current_cmd_mA;
    const int32_t step_mA = now_mA - watch->last_mA;
    const uint32_t size_mA = (uint32_t)(step_mA < 0 ? -step_mA : step_mA);
    watch->largest_step_mA = size_mA > watch->largest_step_mA ? size_mA : watch->largest_step_mA;
    watch->largest_mA = now_mA > watch->largest_mA ? now_mA : watch->largest_mA;
    watch->not_run += runs(&watch->rig) ? 0u : 1u;
    watch->last_mA = now_mA;
}

static void tick(watch_t *watch) {
    rig_prepare(&watch->rig);
    counted_call((counted_function_t)rig_tick, (uintptr_t)&watch->rig, 0, 0);
    rig_pass(&watch->rig);
    look(watch);
}

static void run(watch_t *watch, uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        tick(watch);
    }
}

static void transfer(watch_t *watch, const uint32_t *words) {
    table_feed_t feed;
    can_frame_t frame;
    table_feed_begin(&feed, words, rig_count(words));
    while (table_feed_next(&feed, &frame)) {
        rig_hear(&watch->rig, &frame);
        run(watch, 2);
    }
}

// Until the answer.
static void ask(watch_t *watch, uint8_t operation, uint8_t road, uint32_t value) {
    const can_frame_t request = make_request(operation, road, (int32_t)value, 1);
    rig_hear(&watch->rig, &request);
    for (uint32_t i = 0; i < MOST_ANSWER_ticks; i++) {
        struct quiesce_can_service_reply_t reply;
        tick(watch);
        const can_frame_t *frame = rig_sent(&watch->rig, QUIESCE_CAN_SERVICE_REPLY_FRAME_ID);
        if (frame != NULL) {
            (void)quiesce_can_service_reply_unpack(&reply, frame->data, frame->length);
            const bool is_done = reply.result == QUIESCE_CAN_SERVICE_REPLY_RESULT_DONE_CHOICE;
            watch->done += is_done ? 1u : 0u;
            return;
        }
    }
}

// What was learnt has nothing before it, and ships with nothing.
static void ask_for_change(watch_t *watch, uint32_t number, const uint32_t *words) {
    const uint8_t road = rig_road(words);
    const uint32_t way = road == ROAD_LEARNT ? 0u : number % WAYS;
    if (way == REVERT_WAY) {
        ask(watch, QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_REVERT_CHOICE, road, 0);
    } else if (way == SHIP_WAY) {
        ask(watch, QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SHIP_CHOICE, road, 0);
    } else {
        ask(watch, QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_COMMIT_CHOICE, 0, rig_crc(words));
    }
}

static void change(watch_t *watch, uint32_t number, const uint32_t *words, uint32_t after_ticks) {
    transfer(watch, words);
    while (watch->rig.number % RIG_PERIOD_ticks != number * PHASE_STEP_ticks % RIG_PERIOD_ticks) {
        tick(watch);
    }
    ask_for_change(watch, number, words);
    run(watch, after_ticks);
    watch->largest_mA = 0;
    run(watch, RIG_PERIOD_ticks);
    watch->least_mA = watch->largest_mA < watch->least_mA ? watch->largest_mA : watch->least_mA;
    watch->most_mA = watch->largest_mA > watch->most_mA ? watch->largest_mA : watch->most_mA;
}

static void begin(watch_t *watch) {
    run(watch, RIG_SETTLED_ticks);
    watch->largest_step_mA = 0;
    watch->not_run = 0;
    watch->least_mA = INT32_MAX;
}

// The last table, and the one before it on its road; itself where there is none.
static void find_pair(const rig_order_t *order, const uint32_t *words[2]) {
    words[1] = rig_table(order, order->tables - 1u);
    words[0] = words[1];
    for (uint32_t i = 0; i + 1u < order->tables; i++) {
        if (rig_road(rig_table(order, i)) == rig_road(words[1])) {
            words[0] = rig_table(order, i);
        }
    }
}

int main(void) {
    static watch_t watch;
    const rig_order_t *order = (const rig_order_t *)MAILBOX_BASE;
    const uint32_t *words[2];
    find_pair(order, words);
    if (!rig_start(&watch.rig, order, order->tables - 1u)) {
        return 1;
    }
    counted_call_init();
    begin(&watch);
    for (uint32_t i = 0; i < order->part; i++) {
        change(&watch, i, words[(i + 1u) % 2u], order->ticks);
    }
    print("done", watch.done);
    print("largest_step_mA", watch.largest_step_mA);
    print("not_run", watch.not_run);
    print("least_mA", (uint32_t)watch.least_mA);
    print("most_mA", (uint32_t)watch.most_mA);
    return 0;
}
