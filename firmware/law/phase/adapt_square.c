#include "adapt_square.h"

adapt_move_t adapt_square_corner(uint32_t corner) {
    static const adapt_move_t at[ADAPT_CORNERS] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    return at[corner % ADAPT_CORNERS];
}

void adapt_square_restart(adapt_square_t *self) {
    *self = (adapt_square_t){.last = self->last};
}

void adapt_square_moved(adapt_square_t *self, adapt_move_t move) {
    if (move.on != 0) {
        self->last.on = move.on;
    }
    if (move.off != 0) {
        self->last.off = move.off;
    }
    adapt_square_restart(self);
}

void adapt_square_take(adapt_square_t *self, int32_t cost_q20) {
    const adapt_move_t at = adapt_square_corner(self->corner);
    self->on_q20 += at.on * cost_q20;
    self->off_q20 += at.off * cost_q20;
    self->both_q20 += at.on * at.off * cost_q20;
    self->all_q20 += cost_q20;
    self->corner++;
}

// A steady drift has added 1/5 .. 4/5 of what the centre has changed by to the corners in turn.
void adapt_square_close(adapt_square_t *self, int32_t cost_q20) {
    self->off_q20 += cost_q20 * 4 / 5;
    self->both_q20 += cost_q20 * 2 / 5;
    self->all_q20 -= cost_q20 * 2;
    self->unsteady_q20 += abs_i32(cost_q20);
    self->corner = 0;
    self->rounds++;
}

// A slope is the mean of four measurements of this noise for each round, and a bit more for the
// drift: 0.57 / sqrt(rounds).
int32_t adapt_square_chance_q20(const adapt_square_t *self, int32_t noise_q20) {
    static const uint8_t part_q8[ADAPT_MOST_ROUNDS + 1] = {255, 146, 103, 84};
    return (int32_t)(((int64_t)noise_q20 * part_q8[self->rounds]) >> 8);
}

int32_t adapt_square_bend_q20(const adapt_square_t *self) {
    return self->all_q20 / (ADAPT_CORNERS * self->rounds);
}

adapt_move_t adapt_square_move(const adapt_square_t *self, int32_t noise_q20, int32_t least_q20) {
    // One edge first: both only where that gains more.
    static const adapt_move_t moves[] = {{1, 0}, {-1, 0}, {0, 1},   {0, -1},
                                         {1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    const int32_t corners = ADAPT_CORNERS * self->rounds;
    // Half of the bend for either edge: which of them it belongs to is not known.
    const int32_t bend_q20 = clamp_i32(adapt_square_bend_q20(self), 0, INT32_MAX) / 2;
    const int32_t chance_q20 = adapt_square_chance_q20(self, noise_q20);
    // A step of what disturbs, between any two measurements, makes half of itself a slope.
    const int32_t doubt_q20 = least_q20 + self->unsteady_q20 / (2 * self->rounds);
    adapt_move_t best = {0, 0};
    int32_t best_q20 = 0;
    for (uint32_t i = 0; i < sizeof moves / sizeof moves[0]; i++) {
        const adapt_move_t *at = &moves[i];
        const int32_t edges = at->on * at->on + at->off * at->off;
        const int32_t slopes_q20 =
            (at->on * self->on_q20 + at->off * self->off_q20 + at->on * at->off * self->both_q20) /
            corners;
        const int32_t cost_q20 = slopes_q20 + edges * (bend_q20 + chance_q20) + doubt_q20;
        if (cost_q20 < best_q20) {
            best_q20 = cost_q20;
            best = *at;
        }
    }
    return best;
}

adapt_move_t adapt_square_forward(const adapt_square_t *self, adapt_move_t move) {
    if (move.on == -self->last.on) {
        move.on = 0;
    }
    if (move.off == -self->last.off) {
        move.off = 0;
    }
    return move;
}

// Of a parabola through an edge's slope and its bend, as far as a step: slope^2 / (4 bend), to
// 2^-10 of the slope. From 100 % on more of it is all the same.
static int32_t hope_q20(int32_t slope_q20, int32_t bend_q20) {
    const int32_t slope = clamp_i32(slope_q20, 0, 1 << 20);
    if (slope >= 2 * bend_q20) {
        return slope - bend_q20;
    }
    const int32_t place_q10 = (slope << 10) / (2 * bend_q20); // of its lowest point, in steps
    return (int32_t)(((int64_t)slope * place_q10) >> 11);
}

int32_t adapt_square_hope_q20(const adapt_square_t *self, int32_t noise_q20) {
    const int32_t corners = ADAPT_CORNERS * self->rounds;
    const int32_t bend_q20 = clamp_i32(adapt_square_bend_q20(self), 2, INT32_MAX) / 2;
    const int32_t chance_q20 = adapt_square_chance_q20(self, noise_q20);
    return hope_q20(abs_i32(self->on_q20) / corners + chance_q20, bend_q20) +
           hope_q20(abs_i32(self->off_q20) / corners + chance_q20, bend_q20);
}
