#include "stream.h"

void stream_open(stream_t *self, const char *prefix, uint32_t number) {
    *self = (stream_t){.seed = number};
    for (const char *c = prefix; *c != '\0'; c++) {
        self->seed = self->seed * 31u + (uint8_t)*c;
    }
    quiesce_params_default(&self->params);
    record_start(&self->record, "streams", prefix, number);
}

void stream_start(stream_t *self) {
    const bool is_accepted = quiesce_init(&self->controller, &self->params);
    self->law = is_accepted ? self->params.law : QUIESCE_LAW_FUZZY;
    record_word(&self->record, is_accepted ? 1u : 0u);
}

void stream_step(stream_t *self) {
    quiesce_in_t in = self->in;
    in.tick = ++self->in.tick;
    // Its edge arms: let go at the start and with each acknowledgement.
    in.enable = in.enable && self->tick > 0 && !in.fault_reset;
    self->tick++;
    quiesce_step(&self->controller, &in, &self->out);
    record_tick(&self->record, &self->controller, self->law, &self->out);
}

void stream_close(stream_t *self) {
    record_end(&self->record);
}
