// Flips bits in the words of a controller and looks at what it then commands. In the records that
// decide about the output: every bit and every pair of bits; elsewhere bits at random. Prints one
// JSON object.
//
//     flips SEED SCENES RANDOM    RANDOM flips elsewhere, spread over the scenes of each kind
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "cage.h"
#include "records.h"
#include "rules.h"
#include "scene.h"

enum { BATCH = 256, NOT_NOTICED = SCENE_TICKS };

typedef struct {
    uint64_t done; ///< of the trials of this kind, the one that is tried included
    uint64_t in_records, elsewhere, crashed, not_noticed;
    uint64_t unsafe; ///< trials of any of these
    uint64_t above_ceiling, driver_on, started;
    uint32_t record_ticks; ///< longest from a flip in a record to a fault that says so
    uint32_t stop_ticks;   ///< longest from e-stop to drivers off at the safe current
    char first[160];
} tally_t;

// What happened after a flip.
typedef struct {
    bool is_above, is_on, is_started;
    uint32_t noticed_ticks;
} outcome_t;

typedef struct {
    const scene_t *scene;
    const record_t *records;
    uint32_t record_count;
    const record_t *record; ///< NULL: elsewhere
    uint64_t seed;          ///< of those elsewhere
} trials_t;

static tally_t *tally; // shared with the processes of the batches
static quiesce_t controller;

static int32_t ceiling_mA(const rig_t *rig, uint32_t damper) {
    return rig->has_board ? rig->board.damper[damper].ceiling_mA : QUIESCE_HIGHEST_CURRENT_mA;
}

static void judge(const scene_t *scene, uint32_t tick, const quiesce_out_t *out,
                  outcome_t *outcome) {
    const scene_tick_t *right = &scene->right[tick];
    for (uint32_t i = 0; i < rig_dampers(&scene->rig); i++) {
        const quiesce_command_t *damper = &out->damper[i];
        outcome->is_above |=
            damper->current_cmd_mA < 0 || damper->current_cmd_mA > ceiling_mA(&scene->rig, i);
        outcome->is_on |= right->is_off && damper->driver_enable;
        outcome->is_started |= !rules_is_running(right->state) &&
                               damper->current_cmd_mA != rig_safe_mA(&scene->rig, i) &&
                               damper->current_cmd_mA != 0;
    }
    if (outcome->noticed_ticks == NOT_NOTICED && out->telemetry.state == QUIESCE_STATE_FAULT &&
        out->telemetry.fault != right->fault) {
        outcome->noticed_ticks = tick + 1u;
    }
}

static void flip(uint32_t bit) {
    ((uint8_t *)(void *)&controller)[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
}

static outcome_t try_flips(const scene_t *scene, uint32_t one, uint32_t other) {
    outcome_t outcome = {.noticed_ticks = NOT_NOTICED};
    controller = scene->controller;
    flip(one);
    if (other != one) {
        flip(other);
    }
    for (uint32_t i = 0; i < SCENE_TICKS; i++) {
        quiesce_out_t out;
        quiesce_step(&controller, &scene->in[i], &out);
        judge(scene, i, &out, &outcome);
    }
    return outcome;
}

static void note(const outcome_t *outcome, const char *where, uint32_t one, uint32_t other) {
    tally->above_ceiling += outcome->is_above ? 1u : 0u;
    tally->driver_on += outcome->is_on ? 1u : 0u;
    tally->started += outcome->is_started ? 1u : 0u;
    const bool is_unsafe = outcome->is_above || outcome->is_on || outcome->is_started;
    tally->unsafe += is_unsafe ? 1u : 0u;
    if (is_unsafe && tally->first[0] == '\0') {
        (void)snprintf(tally->first, sizeof tally->first,
                       "%s, bits %" PRIu32 " and %" PRIu32 ": %s", where, one, other,
                       outcome->is_above ? "above the ceiling"
                       : outcome->is_on  ? "driver on in a stop"
                                         : "not the safe current");
    }
}

static void try_in_record(const trials_t *trials, uint32_t one, uint32_t other) {
    const uint32_t first = trials->record->offset * 8u;
    tally->in_records++;
    const outcome_t outcome = try_flips(trials->scene, first + one, first + other);
    tally->not_noticed += outcome.noticed_ticks == NOT_NOTICED ? 1u : 0u;
    if (outcome.noticed_ticks > tally->record_ticks) {
        tally->record_ticks = outcome.noticed_ticks;
    }
    note(&outcome, trials->record->name, one, other);
}

static bool is_in_record(const trials_t *trials, uint32_t bit) {
    for (uint32_t i = 0; i < trials->record_count; i++) {
        if (bit / 8u - trials->records[i].offset < trials->records[i].bytes) {
            return true;
        }
    }
    return false;
}

static void try_elsewhere(const trials_t *trials, uint64_t number) {
    dice_t dice = dice_of(trials->seed, number);
    uint32_t bit = 0;
    do {
        bit = dice_below(&dice, (uint32_t)sizeof(quiesce_t) * 8u);
    } while (is_in_record(trials, bit));
    tally->elsewhere++;
    const outcome_t outcome = try_flips(trials->scene, bit, bit);
    note(&outcome, "elsewhere", bit, bit);
}

// Of a record: every bit with itself and with those above it.
static void try_one(const trials_t *trials, uint64_t number) {
    if (trials->record == NULL) {
        try_elsewhere(trials, number);
        return;
    }
    const uint64_t bits = (uint64_t)trials->record->bytes * 8u;
    if (number % bits >= number / bits) {
        try_in_record(trials, (uint32_t)(number / bits), (uint32_t)(number % bits));
    }
}

typedef struct {
    const trials_t *trials;
    uint64_t end;
} batch_t;

static void try_batch(void *context) {
    const batch_t *batch = context;
    while (tally->done < batch->end) {
        const uint64_t number = tally->done++;
        try_one(batch->trials, number);
    }
}

// A trial that ends its process is over, and no output: on a target the watchdog follows.
static void try_all(const trials_t *trials, uint64_t count) {
    tally->done = 0;
    while (tally->done < count) {
        const uint64_t end = tally->done + BATCH < count ? tally->done + BATCH : count;
        batch_t batch = {trials, end};
        tally->crashed += cage_run(try_batch, &batch) ? 0u : 1u;
    }
}

static bool is_stopped(const scene_t *scene, const quiesce_out_t *out) {
    for (uint32_t i = 0; i < rig_dampers(&scene->rig); i++) {
        if (out->damper[i].driver_enable ||
            out->damper[i].current_cmd_mA != rig_safe_mA(&scene->rig, i)) {
            return false;
        }
    }
    return true;
}

// Ticks from e-stop, so many ticks on, to drivers off at the safe current.
static uint32_t stop_ticks(const scene_t *scene, uint32_t from) {
    quiesce_out_t out = {0};
    controller = scene->controller;
    for (uint32_t tick = 0; tick < SCENE_TICKS; tick++) {
        quiesce_in_t in = scene->in[tick];
        in.estop = tick >= from;
        quiesce_step(&controller, &in, &out);
        if (tick >= from && is_stopped(scene, &out)) {
            return tick - from + 1u;
        }
    }
    return NOT_NOTICED;
}

static void time_stops(const scene_t *scene) {
    for (uint32_t from = 0; from < SCENE_TICKS; from++) {
        const uint32_t ticks = stop_ticks(scene, from);
        tally->stop_ticks = ticks > tally->stop_ticks ? ticks : tally->stop_ticks;
    }
}

static void try_scene(scene_kind_t kind, uint64_t flips, uint64_t seed, dice_t *dice) {
    static scene_t scene;
    record_t records[MOST_RECORDS];
    while (!scene_draw(&scene, kind, dice)) {
    }
    const uint32_t count = records_of(rig_dampers(&scene.rig), records);
    trials_t trials = {.scene = &scene, .records = records, .record_count = count, .seed = seed};
    try_all(&trials, flips);
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t bits = (uint64_t)records[i].bytes * 8u;
        trials.record = &records[i];
        try_all(&trials, bits * bits);
    }
    if (kind == SCENE_RUNNING) {
        time_stops(&scene);
    }
}

static void print(uint64_t seed) {
    printf("{\"seed\": %" PRIu64 ", \"in_records\": %" PRIu64 ", \"elsewhere\": %" PRIu64, seed,
           tally->in_records, tally->elsewhere);
    printf(", \"above_ceiling\": %" PRIu64 ", \"driver_on\": %" PRIu64 ", \"started\": %" PRIu64,
           tally->above_ceiling, tally->driver_on, tally->started);
    printf(", \"unsafe\": %" PRIu64, tally->unsafe);
    printf(", \"crashed\": %" PRIu64 ", \"not_noticed\": %" PRIu64, tally->crashed,
           tally->not_noticed);
    printf(", \"record_ticks\": %" PRIu32 ", \"stop_ticks\": %" PRIu32 ", \"first\": \"%s\"}\n",
           tally->record_ticks, tally->stop_ticks, tally->first);
}

int main(int argc, char **argv) {
    if (argc != 4) {
        fprintf(stderr, "usage: flips SEED SCENES RANDOM\n");
        return 2;
    }
    const uint64_t seed = strtoull(argv[1], NULL, 10);
    const uint64_t scenes = strtoull(argv[2], NULL, 10) * SCENES;
    const uint64_t flips = scenes == 0 ? 0 : strtoull(argv[3], NULL, 10) / scenes;
    tally = cage_share(sizeof *tally);
    if (!cage_is_tight()) {
        fprintf(stderr, "flips: this system cannot keep a process from making system calls\n");
        return 1;
    }
    for (uint64_t i = 0; i < scenes; i++) {
        dice_t dice = dice_of(seed, i);
        try_scene((scene_kind_t)(i % SCENES), flips, seed * scenes + i, &dice);
    }
    print(seed);
    return 0;
}
