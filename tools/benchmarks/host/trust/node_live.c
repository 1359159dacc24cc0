// A controller with its messages: what a bus says, damaged or not, is the operator's and the
// sensors' word; parameters change under way.
#include <stddef.h>
#include <string.h>

#include "can_make.h"
#include "lives.h"
#include "node.h"

enum { LONGEST_LIFE_ticks = 20000, MOST_FRAMES = 4 };

typedef struct {
    node_t node;
    storm_t storm;
    quiesce_in_t in; ///< of the board
    uint8_t alive[QUIESCE_CAN_MESSAGES];
} scene_t;

static can_frame_t make_service(dice_t *dice, uint8_t alive) {
    quiesce_params_t params;
    int32_t value = (int32_t)dice_word(dice);
    const uint8_t index = (uint8_t)dice_below(dice, QUIESCE_PARAM_COUNT + 2u);
    const uint8_t operation = (uint8_t)dice_below(dice, 16);
    if (!dice_one_in(dice, 4)) {
        quiesce_params_default(&params);
        for (uint32_t i = 0; i < 8; i++) {
            rig_draw_param(&params, dice);
        }
        (void)quiesce_param_get(&params, index, &value);
    }
    return make_request(operation, index, value, alive);
}

static can_frame_t make_one(scene_t *self, uint32_t kind, dice_t *dice) {
    const quiesce_in_t *in = &self->in;
    uint8_t *const alive = &self->alive[kind];
    *alive = (uint8_t)(*alive + (dice_one_in(dice, 20) ? dice_below(dice, 16) : 1u)) & 15u;
    const uint32_t sensor = dice_below(dice, QUIESCE_SENSORS);
    switch (kind) {
    case 0:
        return make_operator(in->enable, in->fault_reset, *alive);
    case 1:
        return make_sample(sensor, in->sensor[sensor].counts, *alive);
    case 2:
        return make_driver_of(dice_below(dice, QUIESCE_DAMPERS), (int16_t)dice_word(dice),
                              (uint8_t)dice_below(dice, dice_one_in(dice, 50) ? 8 : 2), *alive);
    case 3:
        return make_stop(in->estop ? QUIESCE_CAN_EMERGENCY_STOP_CODE_STOP_CHOICE : 0, *alive);
    default:
        return make_service(dice, *alive);
    }
}

static void say(scene_t *self, dice_t *dice) {
    const uint32_t count = dice_below(dice, MOST_FRAMES);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t kind = dice_one_in(dice, 40) ? 4u : dice_below(dice, 4);
        can_frame_t frame = make_one(self, kind, dice);
        if (dice_one_in(dice, 4)) {
            frame.data[dice_below(dice, 8)] ^= (uint8_t)(1u << dice_below(dice, 8));
        }
        if (dice_one_in(dice, 50)) {
            frame.length = (uint8_t)dice_below(dice, 16);
        }
        node_receive(&self->node, &frame);
    }
}

static void board_inputs(const quiesce_in_t *in, uint32_t elapsed, node_inputs_t *out) {
    *out = (node_inputs_t){
        .enable = in->enable,
        .estop = in->estop,
        .fault_reset = in->fault_reset,
        .ticks_elapsed = elapsed,
    };
    memcpy(out->sensor, in->sensor, sizeof out->sensor);
    memcpy(out->driver, in->driver, sizeof out->driver);
}

// What node_tick does, with a look between its parts: the limits change with the parameters.
static void tick(scene_t *self, life_t *life) {
    const uint32_t last_tick = self->in.tick;
    can_frame_t frames[NODE_MAX_FRAMES];
    node_inputs_t inputs;
    storm_tick(&self->storm, &self->node.out, &self->in);
    board_inputs(&self->in, self->in.tick - last_tick, &inputs);
    node_step(&self->node, &inputs);
    life_judge(life, &self->node.in, &self->node.out);
    const quiesce_params_t *const params = node_task(&self->node);
    if (params != NULL) {
        node_restart(&self->node, params);
        life->rig.params = self->node.params;
        rules_start(&life->rules, &life->rig);
    }
    (void)node_frames(&self->node, frames);
}

void node_live(life_t *self, dice_t *dice) {
    static scene_t scene;
    const node_sources_t from = {
        .enable = (node_enable_t)dice_below(dice, 3),
        .sensors_on_bus = dice_one_in(dice, 2) ? 0u : dice_below(dice, 1u << QUIESCE_SENSORS),
    };
    memset(&scene, 0, sizeof scene);
    (void)node_init(&scene.node, self->rig.has_board ? &self->rig.board : NULL, &self->rig.params,
                    from);
    rules_start(&self->rules, &self->rig);
    storm_start(&scene.storm, &self->rig, dice);
    const uint32_t ticks = 1u + dice_below(dice, LONGEST_LIFE_ticks);
    for (uint32_t i = 0; i < ticks; i++) {
        say(&scene, dice);
        tick(&scene, self);
    }
}
