// What the current loop costs its interrupt, in instructions: current_loop_step between the
// markers, over currents and supplies that take each of its ways. The order's words: steps, and
// whether the bridge is a full one.
#include "counted_call.h"
#include "current_loop.h"
#include "mailbox.h"
#include "print.h"

typedef struct {
    uint32_t steps;
    uint32_t is_full_bridge;
} order_t;

static uint32_t next(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

// Long runs of one command and nearly one current, in which windows end, then anything.
static void run(current_loop_t *loop, const order_t *order) {
    uint32_t state = 1;
    for (uint32_t i = 0; i < order->steps; i++) {
        const bool is_wild = i / 4096u % 2u == 1u;
        if (i % 512u == 0u) {
            current_loop_command(loop, is_wild ? (int32_t)(next(&state) % 5000u) - 2500 : 1000);
        }
        const int32_t current_mA = is_wild ? (int32_t)(next(&state) % 40000u) - 20000
                                           : 1000 + (int32_t)(next(&state) % 16u);
        const int32_t supply_mV = is_wild ? (int32_t)(next(&state) % 70000u) : 12000;
        counted_call((counted_function_t)current_loop_step, (uintptr_t)loop, (uintptr_t)current_mA,
                     (uintptr_t)supply_mV);
    }
}

int main(void) {
    static current_loop_t loop;
    const order_t order = *(const volatile order_t *)MAILBOX_BASE;
    const current_loop_cfg_t cfg = {.resistance_mohm = 5000,
                                    .gain_mV_a_mA_q8 = 50 * 256,
                                    .integral_time_us = 20000,
                                    .integral_mV = 8000,
                                    .least_duty = order.is_full_bridge ? -CURRENT_LOOP_FULL : 0,
                                    .full_scale_mA = 2000};
    if (!current_loop_init(&loop, &cfg)) {
        return 1;
    }
    counted_call_init();
    run(&loop, &order);
    print("stack_bytes", counted_call_stack_bytes());
    return 0;
}
