// Evaluates a fuzzy system at points that it reads, built with the undefined-behaviour sanitizer.
//
// stdin: uint32 words of the table, its words, uint32 points, then int32 of input 0 at all points,
// of input 1, and so on. stdout: int32 of output 0 at all points, and so on; then the uint32 masks
// of outputs that have their default. Exit code 1 where the table is refused, or stdin too short.
#include <stdio.h>
#include <stdlib.h>

#include "fuzzy_system.h"

// many_system.c
void many_system(const fuzzy_system_t *table, uint32_t points, const int32_t *in, int32_t *out,
                 uint32_t *defaults);

static uint32_t *read_words(uint32_t count) {
    uint32_t *words = malloc(((size_t)count + 1U) * sizeof *words);
    if (words == NULL || fread(words, sizeof *words, count, stdin) != count) {
        exit(1);
    }
    return words;
}

int main(void) {
    uint32_t *words = read_words(1);
    uint32_t *table = read_words(words[0]);
    const fuzzy_system_t *system = (const fuzzy_system_t *)(const void *)table;
    if (fuzzy_system_check(system, words[0]) != 0) {
        return 1;
    }
    uint32_t points = *read_words(1);
    const int32_t *in = (const int32_t *)read_words(points * system->inputs);
    int32_t *out = calloc((size_t)points * system->outputs + 1U, sizeof *out);
    uint32_t *defaults = calloc((size_t)points + 1U, sizeof *defaults);
    if (out == NULL || defaults == NULL) {
        return 1;
    }
    many_system(system, points, in, out, defaults);
    fwrite(out, sizeof *out, (size_t)points * system->outputs, stdout);
    fwrite(defaults, sizeof *defaults, points, stdout);
    return 0;
}
