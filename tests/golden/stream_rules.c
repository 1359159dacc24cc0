// Rule tables are swapped, received in parts, refused and taken back while a law uses them.
#include <string.h>

#include "golden_tables.h"
#include "stream_cases.h"

enum { CASES = 6, TICKS = 8000, RATE_Hz = 1000, PART_WORDS = 40 };

static quiesce_tables_t tables;
static uint32_t scratch[GOLDEN_RULES_MAX_WORDS];

// Copies one of the tables, sometimes damaged or cut short. The rooms keep words of their own.
static uint32_t draw_table(stream_t *self) {
    const golden_table_t *table = &golden_rules[draw_below(&self->seed, GOLDEN_RULES)];
    memcpy(scratch, table->words, table->count * sizeof *table->words);
    if (draw_one_in(&self->seed, 3)) {
        scratch[draw_below(&self->seed, table->count)] ^= 1u << draw_below(&self->seed, 32);
    }
    return table->count - (draw_one_in(&self->seed, 6) ? 1u : 0u);
}

static void receive(stream_t *self) {
    const uint32_t count = draw_table(self);
    for (uint32_t at = 0; at < count; at += PART_WORDS) {
        const uint32_t left = count - at;
        const uint32_t slip = draw_one_in(&self->seed, 40) ? 1u : 0u;
        const bool is_taken = quiesce_tables_write(&tables, at + slip, &scratch[at],
                                                   left < PART_WORDS ? left : PART_WORDS);
        record_word(&self->record, is_taken ? 1u : 0u);
    }
    record_word(&self->record, (uint32_t)quiesce_tables_commit(&tables, &self->controller));
}

// Other words where a table was, which is not in use meanwhile.
static void rewrite(stream_t *self) {
    static uint32_t mine[GOLDEN_RULES_MAX_WORDS];
    const golden_table_t *table = &golden_rules[draw_below(&self->seed, GOLDEN_FITTING_RULES)];
    (void)quiesce_table_drop(&self->controller, QUIESCE_OF_LAW);
    memcpy(mine, table->words, table->count * sizeof *table->words);
    record_word(&self->record, (uint32_t)quiesce_table_use(&self->controller, mine, table->count));
}

static void use(stream_t *self) {
    const golden_table_t *table = &golden_rules[draw_below(&self->seed, GOLDEN_RULES)];
    const uint32_t count = table->count - (draw_one_in(&self->seed, 4) ? 1u : 0u);
    record_word(&self->record, (uint32_t)quiesce_table_use(&self->controller, table->words, count));
}

static void operate(stream_t *self) {
    switch (draw_below(&self->seed, 9)) {
    case 0:
        record_word(&self->record, quiesce_table_drop(&self->controller, QUIESCE_OF_LAW) ? 0 : 1u);
        break;
    case 1:
    case 2:
        use(self);
        break;
    case 3:
        (void)quiesce_tables_revert(&tables, &self->controller, QUIESCE_OF_LAW);
        break;
    case 4:
    case 5:
        rewrite(self);
        break;
    default:
        receive(self);
        break;
    }
}

void stream_rules_cases(stream_t *self) {
    for (uint32_t number = 0; number < CASES; number++) {
        stream_open(self, "rules", number);
        self->params.law = number % 3 == 2 ? QUIESCE_LAW_FUZZY_SELFTUNE : QUIESCE_LAW_FUZZY;
        self->params.selftune_polarity = number < 3 ? 1 : -1;
        self->params.selftune_upper_mHz = number < 3 ? 100000 : 12000;
        self->params.selftune_leak_ms = number < 3 ? 0 : 400;
        self->params.selftune_deadband_um_s2 = number < 3 ? 0 : 50000;
        stream_start(self);
        quiesce_tables_init(&tables);
        self->in = (quiesce_in_t){.sensor = {{.is_fresh = true}}, .enable = true};
        while (self->tick < TICKS) {
            if (self->vibration.left_ticks == 0) {
                draw_steady(&self->seed, RATE_Hz, &self->vibration);
                self->vibration.left_ticks /= 4u;
            }
            if (draw_one_in(&self->seed, 150)) {
                operate(self);
            }
            self->in.sensor[0].counts = draw_sample(&self->seed, &self->vibration);
            stream_step(self);
        }
        stream_close(self);
    }
}
