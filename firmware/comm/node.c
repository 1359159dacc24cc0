#include "node.h"

#include <stddef.h>

#include "quiesce_can.h"

// Between a start and the first step: the command, and what messages that go out before say of it.
// The drivers are off; the self-test wants them so.
static void rest(node_t *node) {
    node->in = (quiesce_in_t){0};
    node->out = (quiesce_out_t){0};
    for (uint32_t i = 0; i < node_dampers(node); i++) {
        node->safe_mA[i] = safe_current_mA(node->board, &node->params, i);
        node->out.damper[i].current_cmd_mA = node->safe_mA[i];
    }
    node->out.telemetry.current_cmd_mA = node->safe_mA[0];
}

bool node_init(node_t *node, const quiesce_board_t *board, const quiesce_params_t *params,
               node_sources_t from) {
    node->board = board;
    node->params = *params;
    node->most_mA = board == NULL ? params->max_current_mA : QUIESCE_HIGHEST_CURRENT_mA;
    node->from = from;
    node->bus = (can_node_inputs_t){0};
    node->said = (can_node_tick_t){0};
    node->restarts = 0;
    node->retunes = 0;
    can_node_init(&node->can, board, params);
    table_service_init(&node->tables, board);
    node->images = (image_service_t){0};
    node->drivers_are_held = false;
    node->held_ticks = 0;
    node->waits_for_release = false;
    node->is_asked = false;
    const bool is_accepted = board == NULL ? quiesce_init(&node->controller, params)
                                           : quiesce_init_board(&node->controller, board, params);
    if (board != NULL) { // a restart reads it again
        quiesce_watch(&node->controller, 0, (const uint32_t *)(const void *)board,
                      sizeof *board / sizeof(uint32_t));
    }
    rest(node);
    return is_accepted;
}

bool node_has_latched_fault(const node_t *node) {
    const quiesce_telemetry_t *t = &node->out.telemetry;
    return t->state == QUIESCE_STATE_FAULT && t->fault != QUIESCE_FAULT_PARAMETER;
}

uint32_t node_dampers(const node_t *node) {
    return QUIESCE_DAMPERS == 1 ? 1u : node->can.dampers;
}

void node_restart(node_t *node, const quiesce_params_t *params) {
    node->params = *params;
    node->restarts++;
    table_service_before_restart(&node->tables, &node->controller);
    (void)quiesce_restart(&node->controller, node->board, params);
    table_service_after_restart(&node->tables, &node->controller);
    rest(node);
    can_node_use_params(&node->can, node->board, &node->params);
}

void node_use_store(node_t *node, keeper_store_t store, void *context) {
    node->tables.keeper.store = store;
    node->tables.keeper.context = context;
}

void node_use_images(node_t *node, const image_store_t *store) {
    image_service_use(&node->images, store);
}

quiesce_table_verdict_t node_found(node_t *node, const table_found_t *found) {
    return table_service_found(&node->tables, &node->controller, found);
}

quiesce_table_verdict_t node_ship(node_t *node, const uint32_t *file) {
    return table_service_ship(&node->tables, &node->controller, file);
}

bool node_offer(node_t *node, const table_found_t *found, quiesce_table_verdict_t *verdict) {
    return table_service_offer(&node->tables, &node->controller, found, verdict);
}

void node_stored(node_t *node, bool is_stored) {
    table_service_stored(&node->tables, is_stored);
}

static bool is_table_data(const can_frame_t *frame) {
    return frame->id == QUIESCE_CAN_TABLE_DATA_FRAME_ID && !frame->is_extended &&
           !frame->is_remote && frame->length == QUIESCE_CAN_TABLE_DATA_LENGTH;
}

void node_receive(node_t *node, const can_frame_t *frame) {
    if (is_table_data(frame)) {
        table_link_take(&node->tables.link, frame, &node->tables.tables);
    } else {
        can_node_receive(&node->can, frame);
    }
}

static bool is_given(const node_t *node, const node_inputs_t *board) {
    switch (node->from.enable) {
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

static bool is_held(const node_t *node) {
    return node->held_ticks > 0u;
}

// While flash is erased, and for a program that is being replaced or has not shown that it works.
static void pass_hold(node_t *node) {
    if (node->drivers_are_held || image_service_holds(&node->images)) {
        node->held_ticks = NODE_HELD_MS * (uint32_t)node->params.tick_rate_Hz / 1000u;
    } else if (node->held_ticks > 0u) {
        node->held_ticks--;
    }
}

// Nothing is armed then, nor by an enable that was there before it could be.
static bool is_enabled(node_t *node, const node_inputs_t *board) {
    const bool is_on = is_given(node, board);
    node->waits_for_release = is_on && (node->waits_for_release || is_held(node));
    return is_on && !node->waits_for_release;
}

// What was had last stays where nothing new has come.
static void take_sample(quiesce_sample_t *sample, const quiesce_sample_t *from) {
    sample->is_fresh = from->is_fresh;
    sample->is_saturated = from->is_saturated;
    if (from->is_fresh) {
        sample->counts = from->counts;
    }
}

// The board's own stage that is off cannot show that it works; one on the bus tells of failures
// only.
static void take_driver(quiesce_driver_t *driver, const quiesce_driver_t *board,
                        const quiesce_driver_t *bus, bool is_off) {
    driver->has_failed = (board->has_failed && !is_off) || bus->has_failed;
    driver->is_measured = board->is_measured || bus->is_measured;
    if (driver->is_measured) {
        driver->current_mA = board->is_measured ? board->current_mA : bus->current_mA;
        driver->is_old = board->is_measured ? board->is_old : bus->is_old;
    }
}

static void take_inputs(node_t *node, const node_inputs_t *board) {
    quiesce_in_t *const in = &node->in;
    in->tick += board->ticks_elapsed;
    in->enable = is_enabled(node, board);
    in->estop = board->estop || node->bus.estop;
    in->fault_reset = board->fault_reset || node->bus.fault_reset;
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        const bool is_on_bus = (node->from.sensors_on_bus >> i & 1u) != 0u;
        take_sample(&in->sensor[i], is_on_bus ? &node->bus.sensor[i] : &board->sensor[i]);
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        take_driver(&in->driver[i], &board->driver[i], &node->bus.driver[i], is_held(node));
    }
}

// The accelerometer that RawSample and FaultFreeze have; a board that is refused may say anything.
static uint32_t tracked_sensor(const node_t *node) {
    const int32_t tracked = node->board != NULL ? node->board->tracked : 0;
    return tracked > 0 && tracked < QUIESCE_SENSORS ? (uint32_t)tracked : 0u;
}

// For the frames; a restart within the tick forgets the inputs.
static void note(node_t *node, const node_inputs_t *board) {
    const quiesce_sample_t *const sample = &node->in.sensor[tracked_sensor(node)];
    node->said = (can_node_tick_t){
        .enable = node->in.enable,
        .estop = node->in.estop,
        .accel_counts = sample->counts,
        .accel_is_fresh = sample->is_fresh,
        .current_meas_mA = node->in.driver[0].current_mA,
        .current_is_measured = node->in.driver[0].is_measured,
        .overruns = board->overruns,
        .lateness_us = board->lateness_us,
        .work_us = board->work_us,
        .cycles = board->cycles,
        .unsent = board->unsent,
        .bus_off_count = board->bus_off_count,
        .rx_lost = board->rx_lost,
        .ticks = board->ticks_elapsed,
        .fault_reset = node->in.fault_reset,
    };
}

void node_step(node_t *node, const node_inputs_t *inputs) {
    can_node_inputs(&node->can, inputs->ticks_elapsed, &node->bus);
    pass_hold(node);
    take_inputs(node, inputs);
    note(node, inputs);
    quiesce_step(&node->controller, &node->in, &node->out);
    if (is_held(node)) {
        quiesce_hold_drivers(&node->controller, &node->in, &node->out);
    }
}

// No sensor of the board provides what the law or its tracker needs.
static bool misses_signal(const node_t *node, const quiesce_params_t *params) {
    quiesce_signal_t missing;
    return node->board != NULL && quiesce_missing(node->board, params, &missing);
}

// What quiesce_params_check refuses.
static void answer_refused(node_t *node, const quiesce_params_t *staged) {
    quiesce_param_error_t error = {0};
    int32_t value = 0;
    (void)quiesce_params_check(staged, &error);
    (void)quiesce_param_get(staged, error.index, &value);
    can_node_answer(&node->can,
                    quiesce_param_allows(error.index, value) ? CAN_NODE_CONTRADICTION
                                                             : CAN_NODE_OUT_OF_RANGE,
                    error.index);
}

bool node_retune(node_t *node, const quiesce_params_t *params) {
    if (!quiesce_params_use(&node->controller, params)) {
        return false;
    }
    node->params = *params;
    node->retunes++;
    can_node_retune(&node->can, params);
    return true;
}

static void accept_live(node_t *node, const quiesce_params_t *staged) {
    uint32_t index = 0;
    if (!quiesce_params_differ_live(&node->params, staged, &index)) {
        can_node_answer(&node->can, CAN_NODE_IS_ARMED, index);
    } else if (node_retune(node, staged)) {
        can_node_answer(&node->can, CAN_NODE_DONE, 0);
    } else {
        answer_refused(node, staged);
    }
}

static const quiesce_params_t *accept_staged(node_t *node) {
    const quiesce_params_t *const staged = can_node_staged(&node->can);
    if (node_has_latched_fault(node)) {
        can_node_answer(&node->can, CAN_NODE_FAULT_IS_LATCHED, 0);
        return NULL;
    }
    if (quiesce_is_armed(&node->controller)) {
        accept_live(node, staged);
        return NULL;
    }
    if (staged->max_current_mA > node->most_mA) {
        can_node_answer(&node->can, CAN_NODE_CONTRADICTION,
                        offsetof(quiesce_params_t, max_current_mA) / sizeof(int32_t));
        return NULL;
    }
    if (quiesce_params_check(staged, NULL)) {
        if (misses_signal(node, staged)) {
            can_node_answer(&node->can, CAN_NODE_CONTRADICTION,
                            offsetof(quiesce_params_t, law) / sizeof(int32_t));
            return NULL;
        }
        can_node_answer(&node->can, CAN_NODE_DONE, 0);
        return staged;
    }
    answer_refused(node, staged);
    return NULL;
}

// Nothing that has changed by itself is kept.
static void save(node_t *node) {
    const uint32_t hash = can_node_param_hash(&node->params);
    bool is_stored = false;
    if (hash != node->can.param_hash || keeper_ask(&node->tables.keeper, KEEPER_PARAMS, hash,
                                                   (const uint32_t *)(const void *)&node->params,
                                                   QUIESCE_PARAM_COUNT, &is_stored)) {
        can_node_answer(&node->can, is_stored ? CAN_NODE_DONE : CAN_NODE_STORE_FAILED, 0);
    }
}

static void work_on_table(node_t *node) {
    can_node_result_t result = CAN_NODE_DONE;
    int32_t value = 0;
    if (table_service_work(&node->tables, &node->controller, can_node_request(&node->can), &result,
                           &value)) {
        can_node_answer_value(&node->can, result, value);
    }
}

static void work_on_image(node_t *node) {
    can_node_result_t result = CAN_NODE_DONE;
    int32_t value = 0;
    const image_work_t work = {
        .request = can_node_request(&node->can),
        .link = &node->tables.link,
        .tables = &node->tables.tables,
        .is_armed = quiesce_is_armed(&node->controller),
        .has_latched_fault = node_has_latched_fault(node),
    };
    if (node->images.work == NULL) {
        can_node_answer(&node->can, CAN_NODE_NO_SUCH_OPERATION, 0);
    } else if (node->images.work(&node->images, &work, &result, &value)) {
        can_node_answer_value(&node->can, result, value);
    }
}

// There is no request any more, whoever's it was.
__attribute__((noinline)) static void rest_services(node_t *node) {
    node->is_asked = false;
    image_service_rest(&node->images);
    table_service_rest(&node->tables);
}

// Apart, as is what else a tick without a request does not do: it saves no registers for it.
__attribute__((noinline)) static const quiesce_params_t *work_on(node_t *node,
                                                                 can_node_task_t task) {
    node->is_asked = true;
    switch (task) {
    case CAN_NODE_APPLY:
        return accept_staged(node);
    case CAN_NODE_SAVE:
        save(node);
        return NULL;
    case CAN_NODE_TABLE:
        work_on_table(node);
        return NULL;
    case CAN_NODE_IMAGE:
        work_on_image(node);
        return NULL;
    case CAN_NODE_NOTHING:
    default:
        return NULL;
    }
}

// In node_tick without a call.
__attribute__((always_inline)) static inline const quiesce_params_t *task_of(node_t *node) {
    const can_node_task_t task = can_node_task(&node->can);
    if (task != CAN_NODE_NOTHING) {
        return work_on(node, task);
    }
    if (node->is_asked) {
        rest_services(node);
    }
    return NULL;
}

// Apart, so that a tick without one saves no registers for it.
__attribute__((noinline)) static bool table_frame(node_t *node, can_frame_t *frame) {
    const table_tick_t tick = {
        .controller = &node->controller,
        .passed_ms = node->can.schedule.passed_ms,
        .is_answered = !node->can.service.is_taken,
    };
    return table_service_tick(&node->tables, &tick, frame);
}

__attribute__((always_inline)) static inline uint32_t
frames_of(node_t *node, can_frame_t frames[NODE_MAX_FRAMES]) {
    uint32_t count = can_node_tick(&node->can, &node->said, &node->out, &node->controller, frames);
    image_service_pass(&node->images, node->can.schedule.passed_ms);
    if (table_service_pass(&node->tables, node->can.schedule.passed_ms) &&
        table_frame(node, &frames[count])) {
        count++;
    }
    return count;
}

const quiesce_params_t *node_task(node_t *node) {
    return task_of(node);
}

uint32_t node_frames(node_t *node, can_frame_t frames[NODE_MAX_FRAMES]) {
    return frames_of(node, frames);
}

uint32_t node_tick(node_t *node, const node_inputs_t *inputs, can_frame_t frames[NODE_MAX_FRAMES]) {
    node_step(node, inputs);
    const quiesce_params_t *const params = task_of(node);
    if (params != NULL) {
        node_restart(node, params);
    }
    return frames_of(node, frames);
}

uint32_t node_farewell(node_t *node, can_frame_t frames[QUIESCE_DAMPERS]) {
    for (uint32_t i = 0; i < node_dampers(node); i++) {
        can_node_farewell(&node->can, i, node->safe_mA[i], &frames[i]);
    }
    return node_dampers(node);
}
