/// Rule tables and a table of pulses as words: part of the recording's input, never made anew.
#ifndef GOLDEN_TABLES_H
#define GOLDEN_TABLES_H

#include <stdint.h>

#define GOLDEN_RULES 6u
/// The first of them fit the controller.
#define GOLDEN_FITTING_RULES 3u
#define GOLDEN_RULES_MAX_WORDS 325u
#define GOLDEN_PULSES_WORDS 33u

typedef struct {
    const uint32_t *words;
    uint32_t count;
} golden_table_t;

extern const golden_table_t golden_rules[GOLDEN_RULES];
extern const uint32_t golden_pulses[GOLDEN_PULSES_WORDS];

#endif
