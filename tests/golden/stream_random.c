// Random vibrations, all laws at all rates: with the default parameters, then with random ones.
#include "stream_cases.h"

enum { LAWS = 5, RATES = 4, CASES = 3 * LAWS * RATES, TICKS = 8000, SETTINGS = 6 };

void stream_random_draw(stream_t *self, uint32_t number) {
    static const int32_t rates_Hz[RATES] = {500, 1000, 2000, 4000};
    do {
        quiesce_params_default(&self->params);
        draw_settings(&self->seed, number < LAWS * RATES ? 0 : SETTINGS, &self->params);
        self->params.law = (int32_t)(number % LAWS);
        self->params.current_check = QUIESCE_CURRENT_CHECK_OFF; // the measured current is noise
        self->params.tick_rate_Hz = rates_Hz[number / LAWS % RATES];
    } while (!quiesce_params_check(&self->params, NULL));
}

static void draw_input(stream_t *self) {
    uint32_t *seed = &self->seed;
    quiesce_in_t *in = &self->in;
    if (self->vibration.left_ticks == 0) {
        (draw_one_in(seed, 2) ? draw_stretch : draw_steady)(seed, self->params.tick_rate_Hz,
                                                            &self->vibration);
        in->tick += draw_one_in(seed, 6) ? 7u : 0u; // lost ticks
    }
    in->sensor[0].counts = draw_sample(seed, &self->vibration);
    in->sensor[0].is_fresh = !draw_one_in(seed, 200);
    in->driver[0].current_mA = draw_between(seed, -6000, 6000);
    in->driver[0].is_measured = draw_one_in(seed, 2);
    in->enable = !draw_one_in(seed, 1500);
    in->estop = draw_one_in(seed, 6000);
    in->fault_reset = draw_one_in(seed, 100);
}

void stream_random_run(stream_t *self) {
    stream_start(self);
    while (self->tick < TICKS) {
        draw_input(self);
        stream_step(self);
    }
    stream_close(self);
}

void stream_random_cases(stream_t *self) {
    for (uint32_t number = 0; number < CASES; number++) {
        stream_open(self, "random", number);
        stream_random_draw(self, number);
        stream_random_run(self);
    }
}
