// What is not a stream: the parameter table, parameters that are refused, the rules on a grid.
#include <stddef.h>

#include "quiesce_rules.h"
#include "stream_cases.h"

enum { REFUSALS = 300, REFUSED_TICKS = 20 };

static void record_text(record_t *record, const char *text) {
    for (const char *c = text == NULL ? "" : text; *c != '\0'; c++) {
        record_word(record, (uint8_t)*c);
    }
}

static void param_case(stream_t *self) {
    stream_open(self, "params", 0);
    for (uint32_t i = 0; i < DRAW_PARAMS; i++) {
        const quiesce_param_info_t *info = quiesce_param_info(i);
        record_text(&self->record, info->name);
        record_text(&self->record, info->unit);
        const int32_t numbers[] = {info->min, info->max, info->default_value};
        record_words(&self->record, (const uint32_t *)numbers, 3);
        record_words(&self->record, (const uint32_t *)info->choices, info->choice_count);
        for (int32_t value = 0; info->labels != NULL && value <= info->max; value++) {
            record_text(&self->record, info->labels[value]);
        }
    }
    stream_close(self);
}

// Values around the ends of a range, some of which contradict others.
static void draw_doubtful(stream_t *self) {
    for (uint32_t i = 0; i < 1u + draw_below(&self->seed, 3); i++) {
        const uint32_t index = draw_below(&self->seed, DRAW_PARAMS);
        const quiesce_param_info_t *info = quiesce_param_info(index);
        const int32_t end = draw_one_in(&self->seed, 2) ? info->min : info->max;
        (void)quiesce_param_set(&self->params, index, end + draw_between(&self->seed, -2, 2));
    }
}

static void refusal_case(stream_t *self) {
    stream_open(self, "refused", 0);
    for (uint32_t i = 0; i < REFUSALS; i++) {
        quiesce_param_error_t error = {0};
        quiesce_params_default(&self->params);
        draw_doubtful(self);
        if (!quiesce_params_check(&self->params, &error)) {
            record_word(&self->record, error.index);
            record_text(&self->record, quiesce_param_info(error.index)->name);
        }
        record_word(&self->record, (uint32_t)quiesce_params_safe_current_mA(&self->params));
        stream_start(self);
        for (uint32_t tick = 0; tick < REFUSED_TICKS; tick++) {
            self->in.sensor[0].counts = draw_between(&self->seed, -1000, 1000);
            self->in.sensor[0].is_fresh = true;
            self->in.enable = true;
            self->in.estop = tick == 7;
            self->in.driver[0].has_failed = tick == 12;
            self->in.fault_reset = tick % 5 == 3;
            stream_step(self);
        }
    }
    stream_close(self);
}

static void surface_case(stream_t *self) {
    stream_open(self, "surface", 0);
    for (int32_t freq_uHz = 0; freq_uHz <= 26000000; freq_uHz += 233333) {
        for (int32_t rms_um_s2 = 0; rms_um_s2 <= 520000; rms_um_s2 += 7777) {
            uint32_t fired = 0;
            const int32_t current_mA = quiesce_rules_current_mA(NULL, freq_uHz, rms_um_s2, &fired);
            record_word(&self->record, (uint32_t)current_mA);
            record_word(&self->record, fired);
        }
    }
    stream_close(self);
}

void stream_table_cases(stream_t *self) {
    param_case(self);
    refusal_case(self);
    surface_case(self);
}
