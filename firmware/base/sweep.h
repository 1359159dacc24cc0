/// Watches words that are not to change: rules, parameters, a board, a program. A few of them are
/// read in every tick, all within half a second; each part's sums then have to be those of its
/// start, so that a change is seen within a second.
/// Any flip of one bit is seen, and nearly all flips of more.
///
/// Sums: of the words, and of those sums, both modulo 2^32. Bounded, about 30 instructions and 6 a
/// word.
#ifndef SWEEP_H
#define SWEEP_H

#include <stdbool.h>
#include <stdint.h>

#define SWEEP_PARTS 5u

typedef struct {
    uint32_t sum;
    uint32_t sum_of_sums;
} sweep_sums_t;

typedef struct {
    const uint32_t *words; ///< the owner's; NULL: those that each step is given
    uint32_t count;        ///< 0: no such part
    sweep_sums_t expected;
} sweep_part_t;

typedef struct {
    sweep_part_t part[SWEEP_PARTS];
    uint32_t pass_ticks;   ///< for all parts together
    uint32_t words_a_tick; ///< follows from it
    uint32_t at_part;
    uint32_t at_word;
    sweep_sums_t sums; ///< of the words of that part before
} sweep_t;

/// Nothing is watched. A pass through all parts takes less than half a second.
void sweep_init(sweep_t *self, uint32_t tick_rate_Hz);

/// Watches these words from now on, as part 0 .. SWEEP_PARTS - 1, in place of what that part was;
/// reads them all. own: what the steps will be given; words == own is kept as such, so that a copy
/// of the owner watches its own words. count 0: the part is given up.
void sweep_watch(sweep_t *self, uint32_t part, const uint32_t *words, uint32_t count,
                 const uint32_t *own);

/// The same, of another sweep, as it was read there.
void sweep_go_on(sweep_t *self, uint32_t part, const sweep_part_t *from);

/// Goes on where another sweep stands that watches words with the same sums, wherever those are.
/// own_part: the one of what steps are given, whose sums are taken over. Returns false, and changes
/// nothing, iff they watch different words.
bool sweep_go_on_all(sweep_t *self, const sweep_t *from, uint32_t own_part);

/// A tick. Returns false iff a part was found changed, once.
bool sweep_step(sweep_t *self, const uint32_t *own);

#endif
