/// Random numbers: the same from the same seed, on every machine.
#ifndef DICE_H
#define DICE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t state;
} dice_t;

/// Any seed and number give streams of their own.
static inline dice_t dice_of(uint64_t seed, uint64_t number) {
    return (dice_t){seed * UINT64_C(0x9E3779B97F4A7C15) + number * UINT64_C(0xD1B54A32D192ED03)};
}

static inline uint32_t dice_word(dice_t *self) {
    self->state += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t word = self->state;
    word = (word ^ word >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    word = (word ^ word >> 27) * UINT64_C(0x94D049BB133111EB);
    return (uint32_t)(word >> 32);
}

/// 0 .. count - 1; 0 for a count of 0.
static inline uint32_t dice_below(dice_t *self, uint32_t count) {
    return (uint32_t)((uint64_t)dice_word(self) * count >> 32);
}

/// low .. high, both included.
static inline int32_t dice_between(dice_t *self, int32_t low, int32_t high) {
    return (int32_t)(low + (int64_t)dice_below(self, (uint32_t)high - (uint32_t)low + 1u));
}

/// True one time in count.
static inline bool dice_one_in(dice_t *self, uint32_t count) {
    return dice_below(self, count) == 0;
}

#endif
