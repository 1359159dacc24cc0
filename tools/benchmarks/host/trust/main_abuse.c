// Drives controllers with everything that can come in, and counts the ticks in which a rule is
// broken. Prints one JSON object. Lives follow each other: a rig, then some thousand ticks of it.
//
//     abuse SEED TICKS
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden_tables.h"
#include "lives.h"

enum { LONGEST_LIFE_ticks = 40000, SWAP_EVERY = 2000 };

// A table that fits, one that does not, one that is damaged, or the one that ships.
static void swap_table(quiesce_t *controller, dice_t *dice) {
    static uint32_t damaged[GOLDEN_RULES_MAX_WORDS];
    const golden_table_t *rules = &golden_rules[dice_below(dice, GOLDEN_RULES)];
    switch (dice_below(dice, 4)) {
    case 0:
        (void)quiesce_table_use(controller, rules->words, rules->count);
        break;
    case 1:
        (void)quiesce_table_use(controller, golden_pulses, GOLDEN_PULSES_WORDS);
        break;
    case 2:
        memcpy(damaged, rules->words, rules->count * sizeof damaged[0]);
        damaged[dice_below(dice, rules->count)] ^= 1u << dice_below(dice, 32);
        if (quiesce_table_use(controller, damaged, rules->count) == QUIESCE_TABLE_OK) {
            (void)quiesce_table_drop(controller, QUIESCE_OF_LAW);
        }
        break;
    default:
        (void)quiesce_table_drop(controller, QUIESCE_OF_LAW);
        break;
    }
}

static void live(life_t *life, dice_t *dice) {
    static quiesce_t controller;
    storm_t storm;
    quiesce_in_t in = {.tick = dice_word(dice)};
    quiesce_out_t out = {0};
    (void)rig_start(&life->rig, &controller);
    rules_start(&life->rules, &life->rig);
    storm_start(&storm, &life->rig, dice);
    const uint32_t ticks = 1u + dice_below(dice, LONGEST_LIFE_ticks);
    for (uint32_t i = 0; i < ticks; i++) {
        storm_tick(&storm, &out, &in);
        if (dice_one_in(dice, SWAP_EVERY)) {
            swap_table(&controller, dice);
        }
        memset(&out, 0xA5, sizeof out); // every word must be written
        quiesce_step(&controller, &in, &out);
        life_judge(life, &in, &out);
    }
}

#if ABUSE_NODE
static void one_life(life_t *life, dice_t *dice) {
    if (dice_one_in(dice, 3)) {
        node_live(life, dice);
    } else {
        live(life, dice);
    }
}
#else
static void one_life(life_t *life, dice_t *dice) {
    live(life, dice);
}
#endif

static void print(const life_t *life, uint64_t seed, uint64_t lives) {
    const rules_t *r = &life->rules;
    printf("{\"seed\": %" PRIu64 ", \"lives\": %" PRIu64 ", \"ticks\": %" PRIu64, seed, lives,
           r->ticks);
    printf(", \"running_ticks\": %" PRIu64 ", \"starts\": %" PRIu64 ", \"stops\": %" PRIu64,
           r->running_ticks, r->starts, r->stops);
    for (uint32_t i = 0; i < RULES; i++) {
        printf(", \"%s\": %" PRIu64, rule_names[i], r->broken[i]);
    }
    printf(", \"first\": \"%s\"}\n", life->first);
}

int main(int argc, char **argv) {
    static life_t life;
    if (argc != 3) {
        fprintf(stderr, "usage: abuse SEED TICKS\n");
        return 2;
    }
    const uint64_t seed = strtoull(argv[1], NULL, 10);
    const uint64_t ticks = strtoull(argv[2], NULL, 10);
    while (life.rules.ticks < ticks) {
        dice_t dice = dice_of(seed, life.number);
        rig_draw(&life.rig, &dice);
        one_life(&life, &dice);
        life.number++;
    }
    print(&life, seed, life.number);
    return 0;
}
