#include "sweep.h"

#include <stddef.h>

static sweep_sums_t add(sweep_sums_t sums, const uint32_t *words, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        sums.sum += words[i];
        sums.sum_of_sums += sums.sum;
    }
    return sums;
}

static void rewind_to(sweep_t *self, uint32_t part) {
    self->at_part = part < SWEEP_PARTS ? part : 0u;
    self->at_word = 0;
    self->sums = (sweep_sums_t){0};
}

void sweep_init(sweep_t *self, uint32_t tick_rate_Hz) {
    // A part's end ends its tick, so that each part may take a tick more.
    *self = (sweep_t){.pass_ticks = tick_rate_Hz * 9u / 20u - SWEEP_PARTS};
}

void sweep_watch(sweep_t *self, uint32_t part, const uint32_t *words, uint32_t count,
                 const uint32_t *own) {
    const sweep_part_t watched = {
        .words = words == own ? NULL : words,
        .count = count,
        .expected = add((sweep_sums_t){0}, words, count),
    };
    sweep_go_on(self, part, &watched);
}

void sweep_go_on(sweep_t *self, uint32_t part, const sweep_part_t *from) {
    uint32_t all = 0;
    self->part[part] = *from;
    for (uint32_t i = 0; i < SWEEP_PARTS; i++) {
        all += self->part[i].count;
    }
    self->words_a_tick = all / self->pass_ticks + 1u;
    rewind_to(self, 0);
}

bool sweep_go_on_all(sweep_t *self, const sweep_t *from, uint32_t own_part) {
    for (uint32_t i = 0; i < SWEEP_PARTS; i++) {
        const sweep_part_t *mine = &self->part[i];
        const sweep_part_t *other = &from->part[i];
        if (mine->count != other->count ||
            (i != own_part && (mine->expected.sum != other->expected.sum ||
                               mine->expected.sum_of_sums != other->expected.sum_of_sums))) {
            return false;
        }
    }
    self->part[own_part].expected = from->part[own_part].expected;
    self->at_part = from->at_part;
    self->at_word = from->at_word;
    self->sums = from->sums;
    return true;
}

bool sweep_step(sweep_t *self, const uint32_t *own) {
    // What has flipped in here itself must not lead out of the parts.
    const uint32_t at = self->at_part < SWEEP_PARTS ? self->at_part : 0u;
    const sweep_part_t *part = &self->part[at];
    const uint32_t *words = part->words != NULL ? part->words : own;
    const uint32_t from = self->at_word < part->count ? self->at_word : part->count;
    const uint32_t left = part->count - from;
    if (left > self->words_a_tick) {
        self->sums = add(self->sums, words + from, self->words_a_tick);
        self->at_word = from + self->words_a_tick;
        return true;
    }
    self->sums = add(self->sums, words + from, left);
    const bool is_same = self->sums.sum == part->expected.sum &&
                         self->sums.sum_of_sums == part->expected.sum_of_sums;
    rewind_to(self, at + 1u);
    return is_same;
}
