// The supervisor on random walks, and what a twin sees.
#include "part.h"
#include "part_cases.h"
#include "supervisor.h"
#include "twin.h"

enum { CASES = 8, WALK_TICKS = 20000, TWIN_ROUNDS = 2000, MOST_WORDS = 6 };

static quiesce_fault_t draw_fault(part_t *part, uint32_t rarity) {
    return part_one_in(part, rarity) ? (quiesce_fault_t)draw_below(&part->seed, QUIESCE_FAULT_COUNT)
                                     : QUIESCE_FAULT_NONE;
}

static void supervisor_case(uint32_t number) {
    static const quiesce_fault_t first[] = {QUIESCE_FAULT_NONE, QUIESCE_FAULT_NONE,
                                            QUIESCE_FAULT_PARAMETER, QUIESCE_FAULT_MEMORY};
    part_t part;
    supervisor_t supervisor;
    supervisor_in_t in = {0};
    part_open(&part, "supervisor", number);
    supervisor_init(&supervisor, first[number % 4u]);
    for (uint32_t i = 0; i < WALK_TICKS; i++) {
        in.enable = part_one_in(&part, 12) ? !in.enable : in.enable;
        in.fault_reset = part_one_in(&part, 6) ? !in.fault_reset : in.fault_reset;
        in.is_ready = part_one_in(&part, 9) ? !in.is_ready : in.is_ready;
        in.is_limited = part_one_in(&part, 9) ? !in.is_limited : in.is_limited;
        in.clearing_fault = draw_fault(&part, 20);
        in.latched_fault = draw_fault(&part, 60);
        if (part_one_in(&part, 4000)) { // final ones end the walk
            supervisor_init(&supervisor, QUIESCE_FAULT_NONE);
        }
        if (part_one_in(&part, 2000)) {
            supervisor.fault_count = UINT32_MAX - draw_below(&part.seed, 3);
        }
        part_word(&part, supervisor_step(&supervisor, &in));
        part_word(&part, supervisor.state);
        part_word(&part, supervisor.fault);
        part_word(&part, supervisor.fault_count);
        part_word(&part, supervisor_allows_output(&supervisor));
        part_word(&part, supervisor_allows_driver(&supervisor));
        part_word(&part, supervisor_is_armed(&supervisor));
        part_word(&part, supervisor_is_tested(&supervisor));
    }
    part_close(&part);
}

static void twin_case(uint32_t number) {
    part_t part;
    uint32_t record[MOST_WORDS], twin[TWIN_WORDS(MOST_WORDS)];
    part_open(&part, "twin", number);
    for (uint32_t i = 0; i < TWIN_ROUNDS; i++) {
        const uint32_t words = 1u + draw_below(&part.seed, MOST_WORDS);
        for (uint32_t k = 0; k < words; k++) {
            record[k] = (uint32_t)part_edge(&part, INT32_MIN, INT32_MAX);
        }
        twin_make(record, words, twin);
        part_word(&part, twin_holds(record, words, twin));
        for (uint32_t flips = 1; flips <= 3; flips++) {
            const uint32_t at = draw_below(&part.seed, 2u * words + 1u);
            uint32_t *const word = at < words ? &record[at] : &twin[at - words];
            *word ^= 1u << draw_below(&part.seed, 32);
            part_word(&part, twin_holds(record, words, twin));
        }
        for (uint32_t k = 0; k <= words; k++) {
            part_word(&part, twin[k]);
        }
    }
    part_close(&part);
}

void part_stop_cases(void) {
    for (uint32_t number = 0; number < CASES; number++) {
        supervisor_case(number);
        twin_case(number);
    }
}
