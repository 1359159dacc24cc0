// What the CAN interface costs, in instructions. Between the markers, by the order's first word:
// 0: can_node_inputs and can_node_tick, 1: can_node_receive of an acceleration sample, 2:
// node_tick, the controller with its messages. Sensor, driver and operator send, raw samples
// stream, a fault comes and goes.
#include "can_make.h"
#include "counted_call.h"
#include "mailbox.h"
#include "node.h"
#include "print.h"
#include "stack.h"

#include <stddef.h>

#define FAULT_EVERY_TICKS 3000u
#define OPERATOR_EVERY_TICKS 100u
#define REQUEST_EVERY_TICKS 10u

enum { COUNT_CAN_TICK = 0, COUNT_RECEIVE = 1, COUNT_NODE_TICK = 2 };

typedef struct {
    uint32_t what;
    uint32_t ticks;
    uint32_t law; ///< its number and 1; 0: the default
} order_t;

typedef struct {
    node_t node;
    node_inputs_t board;
    can_node_tick_t tick;
    can_frame_t frames[NODE_MAX_FRAMES];
} rig_t;

static void tick_messages(rig_t *rig) {
    can_node_inputs(&rig->node.can, 1, &rig->node.bus);
    (void)can_node_tick(&rig->node.can, &rig->tick, &rig->node.out, &rig->node.controller,
                        rig->frames);
}

static void tick_node(rig_t *rig) {
    (void)node_tick(&rig->node, &rig->board, rig->frames);
}

static void receive(rig_t *rig, can_frame_t frame, bool is_counted) {
    if (is_counted) {
        counted_call((counted_function_t)node_receive, (uintptr_t)&rig->node, (uintptr_t)&frame, 0);
    } else {
        node_receive(&rig->node, &frame);
    }
}

static void receive_all(rig_t *rig, uint32_t i, uint32_t what) {
    const uint8_t alive = (uint8_t)(i % 16u);
    receive(rig, make_accel((int32_t)(i * 2654435761u) >> 16, false, false, alive),
            what == COUNT_RECEIVE);
    if (i % OPERATOR_EVERY_TICKS == 0) {
        receive(rig, make_operator(true, false, (uint8_t)(i / OPERATOR_EVERY_TICKS % 16u)), false);
    }
    if (i % REQUEST_EVERY_TICKS == 0) {
        const bool is_stream = i % (100u * REQUEST_EVERY_TICKS) == 0;
        const uint8_t operation = is_stream
                                      ? QUIESCE_CAN_SERVICE_REQUEST_OPERATION_RAW_STREAM_CHOICE
                                      : QUIESCE_CAN_SERVICE_REQUEST_OPERATION_READ_CHOICE;
        receive(rig, make_request(operation, 3, is_stream ? 3600 : 0, alive), false);
    }
}

// The control step alone, between messages.
static void control(rig_t *rig) {
    quiesce_in_t *const in = &rig->node.in;
    in->tick++;
    in->enable = in->tick > 1; // its edge arms
    in->sensor[0] = rig->board.sensor[0];
    quiesce_step(&rig->node.controller, in, &rig->node.out);
    rig->tick.accel_is_fresh = rig->node.bus.sensor[0].is_fresh;
}

static void run(rig_t *rig, const order_t *order) {
    for (uint32_t i = 0; i < order->ticks; i++) {
        receive_all(rig, i, order->what);
        const bool has_fault = i % FAULT_EVERY_TICKS > FAULT_EVERY_TICKS / 2u;
        rig->board.sensor[0].counts = (int32_t)(i * 2654435761u) >> 16;
        rig->board.sensor[0].is_fresh = !has_fault;
        if (order->what == COUNT_NODE_TICK) {
            counted_call((counted_function_t)tick_node, (uintptr_t)rig, 0, 0);
            continue;
        }
        control(rig);
        if (order->what == COUNT_CAN_TICK) {
            counted_call((counted_function_t)tick_messages, (uintptr_t)rig, 0, 0);
        } else {
            tick_messages(rig);
        }
    }
}

int main(void) {
    static rig_t rig;
    const order_t order = *(const volatile order_t *)MAILBOX_BASE;
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = order.law > 0u ? (int32_t)order.law - 1 : params.law;
    rig.board = (node_inputs_t){.enable = true, .ticks_elapsed = 1};
    if (!node_init(&rig.node, NULL, &params, (node_sources_t){.enable = NODE_ENABLE_BOARD})) {
        return 1;
    }
    counted_call_init();
    run(&rig, &order);
    print("ram_bytes", sizeof rig.node.can);
    print("stack_bytes", counted_call_stack_bytes());
    print("rest_stack_bytes", stack_high_water_bytes()); // of the start, and of what is received
    return 0;
}
