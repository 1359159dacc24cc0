#include "node.h"

#include <stddef.h>

// Between a start and the first tick: what the driver was told, for messages that go out before.
static void report_rest(node_t *node, bool is_accepted) {
    const int32_t safe_mA = quiesce_params_safe_current_mA(&node->params);
    node->app.out.current_cmd_mA = safe_mA;
    node->app.out.driver_enable = is_accepted;
    node->app.out.telemetry.current_cmd_mA = safe_mA;
}

bool node_init(node_t *node, const quiesce_params_t *params, node_enable_t enable,
               hal_accel_t *accel, hal_current_t *current) {
    *node = (node_t){
        .params = *params,
        .enable = enable,
        .accel = accel,
        .current = current,
    };
    can_node_init(&node->can, params);
    const bool is_accepted = app_init(&node->app, params, accel, current);
    report_rest(node, is_accepted);
    return is_accepted;
}

bool node_use_params(node_t *node, const quiesce_params_t *params, quiesce_param_error_t *error) {
    if (!quiesce_params_check(params, error)) {
        return false;
    }
    // The driver has its safe current while the controller starts.
    hal_current_write(node->current, quiesce_params_safe_current_mA(params),
                      node->app.out.driver_enable);
    node->params = *params;
    node->restarts++;
    (void)app_init(&node->app, &node->params, node->accel, node->current);
    report_rest(node, true);
    can_node_use_params(&node->can, &node->params);
    return true;
}

void node_receive(node_t *node, const can_frame_t *frame) {
    can_node_receive(&node->can, frame);
}

bool node_accel_sample(const node_t *node, int32_t *counts) {
    if (node->bus.accel_is_fresh) {
        *counts = node->bus.accel_counts;
    }
    return node->bus.accel_is_fresh;
}

bool node_current_measured(const node_t *node, int32_t *current_mA) {
    if (node->bus.current_is_measured) {
        *current_mA = node->bus.current_meas_mA;
    }
    return node->bus.current_is_measured;
}

static bool is_enabled(const node_t *node, const node_inputs_t *board) {
    switch (node->enable) {
    case NODE_ENABLE_BOARD:
        return board->enable;
    case NODE_ENABLE_CAN:
        return node->bus.enable;
    case NODE_ENABLE_BOTH:
        return board->enable && node->bus.enable;
    default:
        return false;
    }
}

// A restart would forget a latched fault; only refused parameters are mended by others.
static bool has_latched_fault(const node_t *node) {
    const quiesce_telemetry_t *t = &node->app.out.telemetry;
    return t->state == QUIESCE_STATE_FAULT && t->fault != QUIESCE_FAULT_PARAMETER;
}

static void apply_staged(node_t *node) {
    if (has_latched_fault(node)) {
        can_node_answer(&node->can, CAN_NODE_FAULT_IS_LATCHED, 0);
        return;
    }
    const quiesce_params_t staged = *can_node_staged(&node->can);
    quiesce_param_error_t error;
    int32_t value = 0;
    if (node_use_params(node, &staged, &error)) {
        can_node_answer(&node->can, CAN_NODE_DONE, 0);
        return;
    }
    (void)quiesce_param_get(&staged, error.index, &value);
    can_node_answer(&node->can,
                    can_service_allows(error.index, value) ? CAN_NODE_CONTRADICTION
                                                           : CAN_NODE_OUT_OF_RANGE,
                    error.index);
}

static void save(node_t *node) {
    const bool is_stored = node->store != NULL && node->store(node->store_context, &node->params);
    if (!is_stored || !node->store_is_slow) {
        can_node_answer(&node->can, is_stored ? CAN_NODE_DONE : CAN_NODE_STORE_FAILED, 0);
    }
}

static void do_task(node_t *node) {
    switch (can_node_task(&node->can)) {
    case CAN_NODE_APPLY:
        apply_staged(node);
        break;
    case CAN_NODE_SAVE:
        save(node);
        break;
    case CAN_NODE_NOTHING:
    default:
        break;
    }
}

uint32_t node_tick(node_t *node, const node_inputs_t *inputs,
                   can_frame_t frames[CAN_NODE_MAX_FRAMES]) {
    can_node_inputs(&node->can, inputs->ticks_elapsed, &node->bus);
    const app_operator_t op = {
        .enable = is_enabled(node, inputs),
        .estop = inputs->estop || node->bus.estop,
        .fault_reset = inputs->fault_reset || node->bus.fault_reset,
        .driver_has_failed = inputs->driver_has_failed || node->bus.driver_has_failed,
    };
    app_tick(&node->app, &op, inputs->ticks_elapsed);
    const can_node_tick_t tick = {
        .enable = op.enable,
        .estop = op.estop,
        .accel_counts = node->app.in.accel_counts,
        .accel_is_fresh = node->app.in.accel_is_fresh,
        .current_meas_mA = node->app.in.current_meas_mA,
        .current_is_measured = node->app.in.current_is_measured,
        .overruns = inputs->overruns,
        .lateness_us = inputs->lateness_us,
        .work_us = inputs->work_us,
        .tx_dropped = inputs->tx_dropped,
        .bus_off_count = inputs->bus_off_count,
    };
    do_task(node);
    return can_node_tick(&node->can, &tick, &node->app.out, frames);
}

void node_leave(node_t *node, can_frame_t *frame) {
    const int32_t safe_mA = quiesce_params_safe_current_mA(&node->params);
    hal_current_write(node->current, safe_mA, false);
    can_node_farewell(&node->can, safe_mA, frame);
}
