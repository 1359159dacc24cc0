// The sensing chain alone, each step bracketed for the instruction counter. The stimulus is made
// outside the bracket. With `watch` the whole controller takes the same input, outside the bracket,
// and what its telemetry says about the run is printed: what the stimulus has done to the chain.
#include <stddef.h>

#include "cost_stimulus.h"
#include "counted_call.h"
#include "mailbox.h"
#include "print.h"
#include "signal_chain.h"

/// What the run is to be; the emulator puts it where the mailbox is otherwise.
typedef struct {
    uint32_t ticks;
    uint32_t tick_rate_Hz;
    uint32_t rms_window_ms;
    uint32_t watch;     ///< 0: the chain only
    uint32_t estimator; ///< value of the parameter
} order_t;

typedef struct {
    quiesce_t controller;
    bool was_valid;
    uint32_t valid_ticks;
    uint32_t lock_losses;
    uint32_t three_peak_ticks;
    uint32_t bad_samples;
    uint32_t fault_kinds; ///< bit per quiesce_fault_t
    uint32_t differing_ticks;
} watch_t;

static void watch_step(watch_t *self, const quiesce_in_t *in, const signal_chain_out_t *chain) {
    quiesce_out_t out;
    quiesce_step(&self->controller, in, &out);
    const quiesce_telemetry_t *t = &out.telemetry;
    const bool is_valid = t->freq_is_valid != 0;
    self->valid_ticks += is_valid ? 1u : 0u;
    self->lock_losses += self->was_valid && !is_valid ? 1u : 0u;
    self->three_peak_ticks += t->peaks[QUIESCE_PEAKS - 1].freq_uHz != 0 ? 1u : 0u;
    self->differing_ticks += t->rms_um_s2 != chain->rms_um_s2 ? 1u : 0u;
    self->bad_samples = t->bad_sample_count;
    self->fault_kinds |= t->fault == QUIESCE_FAULT_NONE ? 0u : 1u << t->fault;
    self->was_valid = is_valid;
}

static void watch_print(const watch_t *self) {
    print("valid_ticks", self->valid_ticks);
    print("lock_losses", self->lock_losses);
    print("three_peak_ticks", self->three_peak_ticks);
    print("bad_samples", self->bad_samples);
    print("fault_kinds", self->fault_kinds);
    print("differing_ticks", self->differing_ticks);
}

// As counted_call() takes it, with what laws would see beside it.
static void chain_step(signal_chain_t *chain, const signal_chain_in_t *in,
                       signal_chain_out_t *out) {
    static view_t view;
    signal_chain_step(chain, in, &view, out);
}

static void run(const order_t *order, signal_chain_t *chain, watch_t *watch) {
    static cost_stimulus_t stimulus;
    uint32_t last_tick = UINT32_MAX;
    cost_stimulus_init(&stimulus, order->tick_rate_Hz);
    for (uint32_t i = 0; i < order->ticks; i++) {
        quiesce_in_t in;
        signal_chain_out_t out;
        cost_stimulus_next(&stimulus, &in);
        const signal_chain_in_t chain_in = {
            .samples = in.sensor,
            .lost_ticks = in.tick - last_tick - 1u,
        };
        counted_call((counted_function_t)chain_step, (uintptr_t)chain, (uintptr_t)&chain_in,
                     (uintptr_t)&out);
        if (watch != NULL) {
            watch_step(watch, &in, &out);
        }
        last_tick = in.tick;
    }
}

// What the parameters say in ticks, as the controller takes it.
static void make_board(quiesce_board_t *board, const quiesce_params_t *params) {
    const int32_t tick_us = 1000000 / params->tick_rate_Hz;
    quiesce_board_default(board);
    board->sensor[0].max_age_us = params->sensor_max_age_ticks * tick_us;
    board->sensor[0].stuck_us = params->sensor_stuck_ticks * tick_us;
}

int main(void) {
    static signal_chain_t chain;
    static watch_t watch;
    const order_t order = *(const volatile order_t *)MAILBOX_BASE;
    quiesce_params_t params;

    quiesce_params_default(&params);
    params.tick_rate_Hz = (int32_t)order.tick_rate_Hz;
    params.rms_window_ms = (int32_t)order.rms_window_ms;
    params.estimator = (int32_t)order.estimator;
    if (order.ticks == 0 || !quiesce_init(&watch.controller, &params)) {
        print("refused", 1);
        return 1;
    }
    quiesce_board_t board;
    make_board(&board, &params);
    signal_chain_init(&chain, &board, &params, 0, NULL);
    counted_call_init();
    run(&order, &chain, order.watch != 0 ? &watch : NULL);
    print("ram_bytes", sizeof chain);
    print("stack_bytes", counted_call_stack_bytes());
    watch_print(&watch);
    return counted_call_stack_bytes() < counted_call_stack_size_bytes() ? 0 : 1;
}
