// Law phase learns on a vibration that its current damps; what it has learnt is saved, loaded,
// forgotten and frozen, and its pulse table is swapped.
#include "golden_tables.h"
#include "stream_cases.h"

enum { CASES = 16, TICKS = 60000, LEARNT_MAX = 4, LEARNT_WORDS = 132 };

typedef struct {
    int32_t damped_q15; ///< what the current takes off the vibration, follows it slowly
    quiesce_learnt_t saved[LEARNT_MAX];
    uint32_t saves;
    uint32_t sweep; ///< 0 or 1: how fast the frequency rises
    bool is_frozen;
} phase_case_t;

static phase_case_t one;

static void draw_case(stream_t *self, uint32_t number) {
    quiesce_params_t *p = &self->params;
    p->law = QUIESCE_LAW_PHASE;
    p->tick_rate_Hz = number % 8 == 4 ? 4000 : 1000;
    p->phase_setting = (int32_t)(number % 2);
    p->phase_blend_ms = draw_between(&self->seed, 0, 600);
    p->adapt = number == 8 ? QUIESCE_ADAPT_FROZEN : QUIESCE_ADAPT_ON;
    p->adapt_start_ms = draw_between(&self->seed, 0, 300);
    p->adapt_settle_ms = draw_between(&self->seed, 50, 120);
    p->adapt_measure_ms = draw_between(&self->seed, 50, 120);
    p->adapt_rest_ms = draw_between(&self->seed, 0, 300);
    p->adapt_edge_limit_mdeg = draw_between(&self->seed, 2000, 60000);
    p->adapt_level_limit_pct = draw_between(&self->seed, 5, 90);
}

// Where in the cycle current does most differs from stretch to stretch, so that trials gain.
static int32_t damped_sample(stream_t *self, phase_case_t *state) {
    const uint32_t best_turn = self->vibration.step_turn[0] * 97u;
    const int32_t effect = draw_sine(16384, self->vibration.phase_turn[0] * 2u + best_turn) + 16384;
    const int32_t wanted_q15 = self->out.damper[0].current_cmd_mA * effect / 10000;
    state->damped_q15 += (wanted_q15 - state->damped_q15) / 64;
    self->vibration.step_turn[0] += self->vibration.step_turn[0] / 65536u * state->sweep;
    const int32_t counts = draw_sample(&self->seed, &self->vibration);
    return (int32_t)((int64_t)counts * (32768 - state->damped_q15) / 32768);
}

static void save(stream_t *self, phase_case_t *state) {
    quiesce_learnt_t *to = &state->saved[state->saves++ % LEARNT_MAX];
    (void)quiesce_learnt_save(&self->controller, to);
    record_words(&self->record, to->words, to->count);
}

static void load(stream_t *self, const phase_case_t *state) {
    quiesce_learnt_t from = state->saved[draw_below(&self->seed, LEARNT_MAX)];
    if (draw_one_in(&self->seed, 4)) {
        from.words[draw_below(&self->seed, LEARNT_WORDS)] ^= 1u << draw_below(&self->seed, 32);
    }
    record_word(&self->record, quiesce_learnt_load(&self->controller, &from) ? 1u : 0u);
}

static void swap_table(stream_t *self) {
    static uint32_t damaged[GOLDEN_PULSES_WORDS];
    for (uint32_t i = 0; i < GOLDEN_PULSES_WORDS; i++) {
        damaged[i] = golden_pulses[i];
    }
    damaged[draw_below(&self->seed, GOLDEN_PULSES_WORDS)] ^= 1u << draw_below(&self->seed, 32);
    static const uint32_t *const tables[] = {golden_pulses, NULL, damaged};
    const uint32_t *words = tables[draw_below(&self->seed, 3)];
    quiesce_table_verdict_t verdict = QUIESCE_TABLE_OK;
    if (words != NULL) {
        verdict = quiesce_table_use(&self->controller, words, GOLDEN_PULSES_WORDS);
    } else {
        (void)quiesce_table_drop(&self->controller, QUIESCE_OF_LAW);
    }
    // The number that it had in the first recording.
    record_word(&self->record, verdict == QUIESCE_TABLE_POINT ? 5u : (uint32_t)verdict);
}

static void operate(stream_t *self, phase_case_t *state) {
    // Frozen until the next one at most.
    state->is_frozen = !state->is_frozen && draw_one_in(&self->seed, 6);
    quiesce_learnt_freeze(&self->controller, state->is_frozen);
    switch (draw_below(&self->seed, 8)) {
    case 0:
        swap_table(self);
        break;
    case 1:
        (void)quiesce_learnt_load(&self->controller, NULL);
        break;
    case 2:
    case 3:
        load(self, state);
        break;
    default:
        save(self, state);
        break;
    }
}

void stream_phase_cases(stream_t *self) {
    for (uint32_t number = 0; number < CASES; number++) {
        one = (phase_case_t){.sweep = number % 4 == 3 ? 1 : 0};
        stream_open(self, "phase", number);
        draw_case(self, number);
        stream_start(self);
        self->in = (quiesce_in_t){.enable = true};
        while (self->tick < TICKS) {
            if (self->vibration.left_ticks == 0) {
                draw_steady(&self->seed, self->params.tick_rate_Hz, &self->vibration);
                self->vibration.left_ticks *= 2u;
            }
            if (draw_one_in(&self->seed, 6000)) {
                operate(self, &one);
            }
            self->in.sensor[0].counts = damped_sample(self, &one);
            self->in.sensor[0].is_fresh = !draw_one_in(&self->seed, 3000);
            stream_step(self);
        }
        save(self, &one);
        stream_close(self);
    }
}
