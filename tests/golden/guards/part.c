#include "part.h"

void part_open(part_t *self, const char *name, uint32_t number) {
    *self = (part_t){.seed = number};
    for (const char *c = name; *c != '\0'; c++) {
        self->seed = self->seed * 31u + (uint8_t)*c;
    }
    record_start(&self->record, "guards", name, number);
}

void part_word(part_t *self, int64_t word) {
    record_words(&self->record, (const uint32_t[]){(uint32_t)word, (uint32_t)(word >> 32)}, 2);
}

void part_close(part_t *self) {
    record_end(&self->record);
}

bool part_one_in(part_t *self, uint32_t count) {
    return draw_one_in(&self->seed, count);
}

static int32_t clamped(int64_t value, int32_t low, int32_t high) {
    return (int32_t)(value < low ? low : value > high ? high : value);
}

int32_t part_edge(part_t *self, int32_t low, int32_t high) {
    const int32_t any = draw_between(&self->seed, low, high);
    switch (draw_below(&self->seed, 8)) {
    case 0:
        return low;
    case 1:
        return high;
    case 2:
        return clamped((int64_t)low + 1, low, high);
    case 3:
        return clamped((int64_t)high - 1, low, high);
    case 4:
        return clamped(draw_between(&self->seed, -3, 3), low, high);
    default:
        return any;
    }
}

int32_t part_near(part_t *self, int64_t value) {
    return clamped(value + draw_between(&self->seed, -2, 2), INT32_MIN, INT32_MAX);
}
