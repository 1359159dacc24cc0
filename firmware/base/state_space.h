/// A linear system in integers: x(k+1) - x(k) = A x(k) + B u(k), y(k) = C x(k) + D u(k).
///
/// Inputs u and states x are below 2^30 in magnitude, in units that whoever makes the coefficients
/// has chosen; coefficients are below 2^24, each row's in units of 2^-shift. Of A only the change
/// in a tick is kept, so that slow and lightly damped poles keep all their digits. What a state's
/// shift cuts off is carried to the next tick: what is rounded away has the mean 0 and adds up to
/// nothing.
///
/// Words of a state: shift, n coefficients of x, m of u. Products are below 2^54 and sums of 24 of
/// them and a remainder below 2^59. About 8 instructions a coefficient that is worked off.
#ifndef STATE_SPACE_H
#define STATE_SPACE_H

#include <stdbool.h>
#include <stdint.h>

#define STATE_SPACE_MAX_STATES 12u
#define STATE_SPACE_MAX_INPUTS 12u
#define STATE_SPACE_MAX_SHIFT 46u ///< of a state
#define STATE_SPACE_COEFFICIENT_LIMIT (1 << 24)

/// Zeros: at rest.
typedef struct {
    int32_t x[STATE_SPACE_MAX_STATES];
    int64_t rest[STATE_SPACE_MAX_STATES]; ///< 0 .. 2^shift - 1 of its row
} state_space_t;

/// Whether count coefficients are below 2^24 in magnitude.
bool state_space_are_coefficients_good(const int32_t *coefficients, uint32_t count);

/// Whether the words of n states are good. n and m are in their ranges.
bool state_space_are_states_good(const int32_t *words, uint32_t n, uint32_t m);

/// Words of n states.
static inline uint32_t state_space_words(uint32_t n, uint32_t m) {
    return n * (1u + n + m);
}

/// C x + D u of one row, n + m coefficients, in units of 2^-shift of the result's.
int64_t state_space_output(const state_space_t *self, const int32_t *row, uint32_t n, uint32_t m,
                           const int32_t *u);

/// One tick on. Returns false where a state has left its range: all of it is at rest again then.
bool state_space_step(state_space_t *self, const int32_t *words, uint32_t n, uint32_t m,
                      const int32_t *u);

#endif
