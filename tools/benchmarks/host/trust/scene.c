#include "scene.h"

#include "rules.h"

enum { PATIENCE_ticks = 8000, DISABLED_ticks = 600, LONGEST_RUN_ticks = 3000, SETTLING_ticks = 5 };

typedef struct {
    dice_t *dice;
    quiesce_in_t in;
    quiesce_out_t out;
    uint32_t phase_turn;
} live_t;

// A vibration, and drivers that follow.
static void prepare(live_t *live) {
    live->in.tick++;
    live->phase_turn += UINT32_MAX / 100u;
    const int32_t x = (int32_t)live->phase_turn / 65536; // half turns Q15
    const int32_t arch = x * (32768 - (x < 0 ? -x : x)) / 8192;
    for (uint32_t i = 0; i < QUIESCE_SENSORS; i++) {
        live->in.sensor[i].counts = arch / 2 + dice_between(live->dice, -40, 40);
        live->in.sensor[i].is_fresh = true;
    }
    for (uint32_t i = 0; i < QUIESCE_DAMPERS; i++) {
        live->in.driver[i].current_mA =
            live->out.damper[i].driver_enable ? live->out.damper[i].current_cmd_mA : 0;
        live->in.driver[i].is_measured = true;
    }
}

static void step(scene_t *self, live_t *live, uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        prepare(live);
        quiesce_step(&self->controller, &live->in, &live->out);
    }
}

static bool comes_to_run(scene_t *self, live_t *live) {
    step(self, live, DISABLED_ticks);
    live->in.enable = true;
    for (uint32_t i = 0; i < PATIENCE_ticks; i++) {
        step(self, live, 1);
        if (rules_is_running(live->out.telemetry.state)) {
            step(self, live, dice_below(live->dice, LONGEST_RUN_ticks));
            return rules_is_running(live->out.telemetry.state);
        }
    }
    return false;
}

static void lead_to(scene_t *self, scene_kind_t kind, live_t *live) {
    live->in.estop = kind == SCENE_STOPPING || kind == SCENE_STOPPED;
    live->in.enable = kind != SCENE_IDLE;
    step(self, live, kind == SCENE_RUNNING ? 0 : SETTLING_ticks);
    live->in.estop = kind == SCENE_STOPPING;
    step(self, live, kind == SCENE_STOPPED ? SETTLING_ticks : 0);
}

// Returns false where a fault comes or goes by itself meanwhile: to delay one is no failure to
// stop.
static bool record(scene_t *self, scene_kind_t kind, live_t *live) {
    const bool is_stop = kind == SCENE_STOPPING || kind == SCENE_STOPPED;
    const quiesce_t moment = self->controller;
    bool is_steady = true;
    for (uint32_t i = 0; i < SCENE_TICKS; i++) {
        step(self, live, 1);
        self->in[i] = live->in;
        self->right[i] = (scene_tick_t){
            .state = live->out.telemetry.state,
            .fault = live->out.telemetry.fault,
            .is_off = !live->out.damper[0].driver_enable,
        };
        is_steady = is_steady && self->right[i].is_off == is_stop;
    }
    self->controller = moment;
    return is_steady;
}

bool scene_draw(scene_t *self, scene_kind_t kind, dice_t *dice) {
    live_t live = {.dice = dice, .phase_turn = dice_word(dice)};
    rig_draw(&self->rig, dice);
    if (!rig_start(&self->rig, &self->controller) || !comes_to_run(self, &live)) {
        return false;
    }
    lead_to(self, kind, &live);
    return record(self, kind, &live);
}
