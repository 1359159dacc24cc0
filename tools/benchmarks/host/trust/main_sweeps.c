// Flips a bit of what a controller only reads, its parameters, its table or its program, while it
// runs, and looks how long it takes to notice. Prints one JSON object.
//
//     sweeps SEED FLIPS
#include "controller.c" // NOLINT(bugprone-suspicious-include): its parameters are inside

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cage.h"
#include "dice.h"
#include "golden_tables.h"

enum { BATCH = 16, STARTING_ms = 700, LONGEST_ms = 2000, PROGRAM_WORDS = 30000 };

typedef enum { PARAMETERS, RULES, PULSES, PROGRAM, KINDS } kind_t;

typedef struct {
    uint64_t done, noticed, not_noticed, crashed, above_ceiling, driver_on;
    uint32_t longest_us;     ///< from the flip to the fault
    uint32_t reaction_ticks; ///< from there to drivers off without current
} tally_t;

typedef struct {
    quiesce_t controller;
    quiesce_in_t in;
    quiesce_out_t out;
    uint32_t rate_Hz;
    dice_t dice;
} rig_t;

typedef struct {
    uint64_t seed, end;
} batch_t;

static tally_t *tally;
static uint32_t copied[QUIESCE_TABLE_WORDS];
static uint32_t program[PROGRAM_WORDS];

static void step(rig_t *rig) {
    rig->in.tick++;
    rig->in.enable = rig->in.tick > 1u;
    // A vibration of a hundred ticks in some noise.
    const int32_t x = (int32_t)(rig->in.tick * (UINT32_MAX / 100u)) / 65536;
    rig->in.sensor[0].counts =
        x * (32768 - (x < 0 ? -x : x)) / 16384 + dice_between(&rig->dice, -99, 99);
    rig->in.sensor[0].is_fresh = true;
    quiesce_step(&rig->controller, &rig->in, &rig->out);
}

static void run(rig_t *rig, uint32_t time_ms) {
    for (uint32_t i = time_ms * rig->rate_Hz / 1000u; i > 0; i--) {
        step(rig);
    }
}

static uint32_t use(rig_t *rig, const uint32_t *words, uint32_t count) {
    memcpy(copied, words, count * sizeof *words);
    return quiesce_table_use(&rig->controller, copied, count) == QUIESCE_TABLE_OK ? count : 0;
}

// Starts it. Returns how many words there are to flip a bit of; *words: the first one.
static uint32_t start(rig_t *rig, kind_t kind, uint32_t **words) {
    static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    quiesce_params_t params;
    uint32_t count = 0;
    quiesce_params_default(&params);
    rig->rate_Hz = rates_Hz[dice_below(&rig->dice, 4)];
    params.tick_rate_Hz = (int32_t)rig->rate_Hz;
    params.law = kind == PULSES ? QUIESCE_LAW_PHASE
                 : kind == RULES
                     ? dice_between(&rig->dice, QUIESCE_LAW_FUZZY, QUIESCE_LAW_FUZZY_SELFTUNE)
                     : dice_between(&rig->dice, QUIESCE_LAW_OFF, QUIESCE_LAW_PHASE);
    (void)quiesce_init(&rig->controller, &params);
    quiesce_watch(&rig->controller, QUIESCE_WATCHES - 1u, program, PROGRAM_WORDS);
    *words = kind == PROGRAM ? program : copied;
    if (kind == PARAMETERS) {
        controller_t *inside = (controller_t *)(void *)rig->controller.opaque;
        *words = (uint32_t *)(void *)&inside->control.setup.params;
        count = QUIESCE_PARAM_COUNT;
    } else if (kind == RULES) {
        const golden_table_t *rules = &golden_rules[dice_below(&rig->dice, GOLDEN_FITTING_RULES)];
        count = use(rig, rules->words, rules->count);
    } else {
        count = kind == PULSES ? use(rig, golden_pulses, GOLDEN_PULSES_WORDS) : PROGRAM_WORDS;
    }
    return count;
}

static void judge(const rig_t *rig) {
    const int32_t current_mA = rig->out.damper[0].current_cmd_mA;
    tally->above_ceiling += current_mA < 0 || current_mA > QUIESCE_HIGHEST_CURRENT_mA ? 1u : 0u;
}

static void note(rig_t *rig, uint32_t ticks) {
    const uint32_t time_us = (uint32_t)(ticks * UINT64_C(1000000) / rig->rate_Hz);
    uint32_t reaction = 1;
    tally->longest_us = time_us > tally->longest_us ? time_us : tally->longest_us;
    while (rig->out.damper[0].driver_enable || rig->out.damper[0].current_cmd_mA != 0) {
        step(rig);
        reaction++;
    }
    tally->reaction_ticks = reaction > tally->reaction_ticks ? reaction : tally->reaction_ticks;
    run(rig, 50);
    tally->driver_on += rig->out.damper[0].driver_enable ? 1u : 0u;
    tally->noticed++; // now: one that ends the program here counts as that alone
}

static void try_one(uint64_t seed, uint64_t number) {
    static rig_t rig;
    uint32_t *words = NULL;
    rig = (rig_t){.dice = dice_of(seed, number)};
    const uint32_t count = start(&rig, (kind_t)(number % KINDS), &words);
    if (count == 0) {
        return; // neither noticed nor not: it is missed in the sum
    }
    run(&rig, STARTING_ms + dice_below(&rig.dice, 1000));
    const uint32_t bit = dice_below(&rig.dice, count * 32u);
    words[bit / 32u] ^= UINT32_C(1) << bit % 32u;
    const uint32_t longest = LONGEST_ms * rig.rate_Hz / 1000u;
    for (uint32_t ticks = 1; ticks <= longest; ticks++) {
        step(&rig);
        judge(&rig);
        if (rig.out.telemetry.fault == QUIESCE_FAULT_MEMORY) {
            note(&rig, ticks);
            return;
        }
    }
    tally->not_noticed++;
}

static void try_batch(void *context) {
    const batch_t *batch = context;
    while (tally->done < batch->end) {
        const uint64_t number = tally->done++;
        try_one(batch->seed, number);
    }
}

int main(int argc, char **argv) {
    if (argc != 3) {
        fprintf(stderr, "usage: sweeps SEED FLIPS\n");
        return 2;
    }
    const uint64_t flips = strtoull(argv[2], NULL, 10);
    batch_t batch = {.seed = strtoull(argv[1], NULL, 10)};
    dice_t dice = dice_of(batch.seed, UINT64_MAX);
    for (uint32_t i = 0; i < PROGRAM_WORDS; i++) {
        program[i] = dice_word(&dice);
    }
    tally = cage_share(sizeof *tally);
    if (!cage_is_tight()) {
        fprintf(stderr, "sweeps: this system cannot keep a process from making system calls\n");
        return 1;
    }
    while (tally->done < flips) {
        batch.end = tally->done + BATCH < flips ? tally->done + BATCH : flips;
        tally->crashed += cage_run(try_batch, &batch) ? 0u : 1u;
    }
    printf("{\"seed\": %" PRIu64 ", \"tried\": %" PRIu64 ", \"noticed\": %" PRIu64, batch.seed,
           flips, tally->noticed);
    printf(", \"not_noticed\": %" PRIu64 ", \"crashed\": %" PRIu64, tally->not_noticed,
           tally->crashed);
    printf(", \"above_ceiling\": %" PRIu64 ", \"driver_on\": %" PRIu64, tally->above_ceiling,
           tally->driver_on);
    printf(", \"longest_us\": %" PRIu32 ", \"reaction_ticks\": %" PRIu32 "}\n", tally->longest_us,
           tally->reaction_ticks);
    return 0;
}
