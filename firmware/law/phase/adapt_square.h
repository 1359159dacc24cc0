/// Two edges of a pulse at once: what it costs at the corners of a square around where they are.
///
/// Four corners, each a step earlier or later in both edges, give the slope along either edge and
/// what they have in common, each from all four measurements: twice as sure as one edge after the
/// other, and it sees a valley that runs diagonally (a coil of another lag moves both edges). The
/// centre is measured before the first corner and after the last. What it has changed by in
/// between counts against a move, and so does the noise of the measurements; rounds about the same
/// centre add up until little is left of that.
///
/// Source: two-level factorial design (Box, Hunter and Hunter, Statistics for Experimenters). Costs
/// are relative changes in Q20, within +-ADAPT_MOST_COST_Q20. Bounded: some 35 instructions a
/// corner, 170 a round.
#ifndef ADAPT_SQUARE_H
#define ADAPT_SQUARE_H

#include "adapt_cost.h"

enum {
    ADAPT_CORNERS = 4,
    ADAPT_MOST_ROUNDS = 3,
};

/// Steps of either edge: -1, 0 or 1, later is positive.
typedef struct {
    int8_t on;
    int8_t off;
} adapt_move_t;

typedef struct {
    int32_t on_q20; ///< sums of the corners' costs, each with the sign of its step
    int32_t off_q20;
    int32_t both_q20;     ///< with the product of both signs
    int32_t all_q20;      ///< without a sign: how the cost bends
    int32_t unsteady_q20; ///< sum of what the centre has changed by, of either sign
    uint8_t corner;       ///< that is next; ADAPT_CORNERS: the centre again
    uint8_t rounds;       ///< finished
    adapt_move_t last;    ///< last move of either edge with steps of this size
} adapt_square_t;

/// Where corner 0 .. 3 lies. Only one edge differs from one to the next.
adapt_move_t adapt_square_corner(uint32_t corner);

static inline bool adapt_is_move(adapt_move_t move) {
    return move.on != 0 || move.off != 0;
}

/// What was measured does not count: starts anew.
void adapt_square_restart(adapt_square_t *self);

/// The centre has made this move: starts anew around it.
void adapt_square_moved(adapt_square_t *self, adapt_move_t move);

/// The next corner costs so much more than the centre did.
void adapt_square_take(adapt_square_t *self, int32_t cost_q20);

/// All corners are taken, and the centre now costs so much more than at first.
void adapt_square_close(adapt_square_t *self, int32_t cost_q20);

/// The move that is sure to gain, the most of them, or {0, 0}. noise_q20: standard deviation of
/// one measurement. least_q20: less is not worth a move.
adapt_move_t adapt_square_move(const adapt_square_t *self, int32_t noise_q20, int32_t least_q20);

/// What the corners cost on average: how the cost bends.
int32_t adapt_square_bend_q20(const adapt_square_t *self);

/// The move without an edge that would go back where it has come from: its best place is less than
/// a step away.
adapt_move_t adapt_square_forward(const adapt_square_t *self, adapt_move_t move);

/// What of a cost's slope may be chance after the rounds so far, one standard deviation.
int32_t adapt_square_chance_q20(const adapt_square_t *self, int32_t noise_q20);

/// What moves within a step of the centre may gain at most, by a parabola through the slopes, each
/// with its chance, and the bend; after a round at least.
int32_t adapt_square_hope_q20(const adapt_square_t *self, int32_t noise_q20);

#endif
