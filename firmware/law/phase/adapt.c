#include "adapt.h"

#include <stddef.h>

enum {
    EDGE_STEP_q16 = 4369,      // 12 degrees, or half of it
    LEVEL_STEP_q15 = 4915,     // 15 %
    GAIN_q20 = 2097,           // 0.2 %: less is not worth a move
    NOISY_q20 = 6291,          // 0.6 %
    STEEP_q20 = 10486,         // 1 %: what the corners of small steps cost, on average
    DISTURBED_q20 = 20972,     // 2 %
    CLEARLY_WORSE_q20 = 10486, // 1 %
    LOST_q20 = 31457,          // 3 %: cost of a corner at which the lock is lost
    LOST_CORNERS = 3,          // of a round: the square is too large
    NOISE_SHIFT = 3,           // measurements that the noise is averaged over: 8
    DRIFT_DIVISOR = 50,        // of the frequency: 2 %
    FREQ_MEAN = 8,             // half cycles
    DIRECTIONS = 2,
    NOWHERE = UINT8_MAX,
    SEARCH_MEASUREMENTS = 19, // of full length, with their settling: so long a search may take
    MORE_MEASUREMENTS = 6,    // after a gain at least: a round
    LIMIT_PART = 256,         // of the limit of acceleration: so far above it is not above
    FREE_TRIALS = 2,          // without current, that may lose the lock
    PARTS_LOG2 = 3,           // shortest part of a measurement: an eighth of it
    LONGEST_LOG2 = 2,         // longest: half of it
    SQRT_HALF_q8 = 181,
    HALF_q15 = 1 << 14,
    HALF_q16 = 1 << 15,
};

void adapt_init(adapt_t *self, const adapt_cfg_t *cfg) {
    *self = (adapt_t){.cfg = *cfg, .noise_q20 = GAIN_q20, .moved_index = NOWHERE};
}

void adapt_clear(adapt_t *self) {
    const adapt_cfg_t cfg = self->cfg;
    adapt_init(self, &cfg);
}

static void wait_for(adapt_t *self, adapt_state_t state, uint32_t ticks) {
    self->state = (uint8_t)state;
    self->ticks = ticks;
    self->is_due = false;
    adapt_meter_reset(&self->meter);
}

static bool has_moved(const adapt_t *self) {
    return gap_u32(self->now_mHz, self->freq_mHz) > self->freq_mHz / DRIFT_DIVISOR;
}

static void start_part(adapt_t *self, uint32_t part) {
    self->part = (uint8_t)part;
    self->size = ADAPT_FIRST;
    self->failures = 0;
    self->direction = -1;
    self->square = (adapt_square_t){0};
}

static uint32_t ticks_of(const adapt_t *self, uint32_t measurements) {
    return measurements * (self->cfg.settle_ticks + self->cfg.measure_ticks);
}

// A search that has just gained something goes on.
static void go_on(adapt_t *self) {
    const uint32_t least_ticks = ticks_of(self, MORE_MEASUREMENTS);
    self->left_ticks = self->left_ticks > least_ticks ? self->left_ticks : least_ticks;
}

// What is known of the vibration without current does not hold any more.
static void forget_free(adapt_t *self) {
    self->free_rms_um_s2 = 0;
    self->free_failures = 0;
}

// The vibration is another one: it must last before the search starts.
static void start_search(adapt_t *self) {
    self->freq_mHz = self->now_mHz;
    self->noise_q20 = GAIN_q20;
    forget_free(self);
    self->left_ticks = ticks_of(self, SEARCH_MEASUREMENTS) + self->cfg.start_ticks;
    start_part(self, ADAPT_TRY_WHOLE);
    wait_for(self, ADAPT_MEASURING, self->cfg.start_ticks);
}

static uint32_t limit_um_s2(const adapt_t *self) {
    return adapt_limit_um_s2(self->goal, self->free_rms_um_s2);
}

static int32_t cost_q20(const adapt_t *self, adapt_effect_t from, adapt_effect_t to) {
    return adapt_cost_q20(from, to, self->goal, limit_um_s2(self));
}

static int32_t limited(const adapt_cfg_t *cfg, uint32_t coordinate, int32_t value) {
    switch (coordinate) {
    case ADAPT_WHOLE:
        return clamp_i32(value, 0, 1);
    case ADAPT_LEVEL:
        return clamp_i32(value, -cfg->level_limit_q15, 0);
    default:
        return clamp_i32(value, -cfg->edge_limit_q16, cfg->edge_limit_q16);
    }
}

static void change(const adapt_t *self, adapt_trim_t *trim, uint32_t coordinate, int32_t by) {
    int16_t *value = &trim->value[coordinate];
    *value = (int16_t)limited(&self->cfg, coordinate, *value + by);
}

static void change_edges(const adapt_t *self, adapt_trim_t *trim, adapt_move_t move) {
    const int32_t step_q16 = self->size == ADAPT_LARGE ? EDGE_STEP_q16 : EDGE_STEP_q16 / 2;
    change(self, trim, ADAPT_ON_EDGE, move.on * step_q16);
    change(self, trim, ADAPT_OFF_EDGE, move.off * step_q16);
}

// From the level as it is down to no current, during the first half of the time to settle: a lock
// does not follow a jump. Times are below 2^18 ticks.
static int16_t fading_q15(const adapt_t *self, int16_t level_q15) {
    const uint32_t ramp_ticks = self->cfg.settle_ticks;
    const uint32_t left_ticks = self->ticks > ramp_ticks ? self->ticks - ramp_ticks : 0;
    const int32_t left_q14 = (int32_t)((left_ticks << 14) / (ramp_ticks | 1u));
    const int32_t now_q15 =
        ADAPT_NO_CURRENT +
        (((level_q15 - ADAPT_NO_CURRENT) * clamp_i32(left_q14, 0, 1 << 14)) >> 14);
    return (int16_t)now_q15;
}

// The pulse with the change that is tried.
static adapt_trim_t changed(const adapt_t *self, adapt_trim_t trim) {
    if (self->is_free) {
        trim.value[ADAPT_LEVEL] = fading_q15(self, trim.value[ADAPT_LEVEL]);
        return trim;
    }
    switch (self->part) {
    case ADAPT_TRY_WHOLE:
        change(self, &trim, ADAPT_WHOLE, trim.value[ADAPT_WHOLE] == 0 ? 1 : -1);
        break;
    case ADAPT_TRY_EDGES:
        change_edges(self, &trim, adapt_square_corner(self->square.corner));
        break;
    default:
        change(self, &trim, ADAPT_LEVEL, self->direction * LEVEL_STEP_q15);
        break;
    }
    return trim;
}

// Whether there is something to try in this part of the search.
static bool has_room(const adapt_t *self) {
    const adapt_trim_t *now = &self->trim[self->nearest];
    if (self->part == ADAPT_TRY_EDGES) {
        return now->value[ADAPT_WHOLE] == 0 && self->cfg.edge_limit_q16 > 0;
    }
    return self->part == ADAPT_TRY_WHOLE ||
           changed(self, *now).value[ADAPT_LEVEL] != now->value[ADAPT_LEVEL];
}

static void resize(adapt_t *self, uint32_t size) {
    self->size = (uint8_t)size;
    self->square = (adapt_square_t){0};
    self->failures = 0;
}

// Steps of this size are too large.
static void shrink(adapt_t *self) {
    if (self->size == ADAPT_LARGE) {
        resize(self, ADAPT_LAST);
    } else {
        start_part(self, self->part + 1u);
    }
}

// A whole pulse or a level is no gain.
static void fail(adapt_t *self) {
    self->direction = (int8_t)-self->direction;
    self->failures++;
    if (self->part == ADAPT_TRY_WHOLE || self->failures >= DIRECTIONS) {
        start_part(self, self->part + 1u);
    }
}

// Whether a round of small steps tells little.
static bool is_noisy(const adapt_t *self) {
    return self->noise_q20 > NOISY_q20;
}

static void skip_what_has_no_room(adapt_t *self) {
    if (self->part == ADAPT_TRY_EDGES && !has_room(self)) {
        start_part(self, ADAPT_TRY_LEVEL);
    }
    for (uint32_t i = 0; i < DIRECTIONS && self->part == ADAPT_TRY_LEVEL && !has_room(self); i++) {
        fail(self);
    }
}

// The edges have been tried for long enough; while acceleration is above its limit it goes on.
static bool is_over(const adapt_t *self) {
    const uint32_t most_um_s2 = limit_um_s2(self);
    return self->left_ticks == 0 &&
           self->before.rms_um_s2 <= (uint64_t)most_um_s2 + most_um_s2 / LIMIT_PART;
}

static void rest(adapt_t *self) {
    const bool is_whole = self->trim[self->nearest].value[ADAPT_WHOLE] != 0;
    start_part(self, is_whole ? ADAPT_TRY_WHOLE : ADAPT_TRY_EDGES);
    self->left_ticks = ticks_of(self, SEARCH_MEASUREMENTS);
    wait_for(self, ADAPT_RESTING, self->cfg.rest_ticks);
}

static void try_next(adapt_t *self) {
    if (self->part == ADAPT_TRY_EDGES && is_over(self)) {
        start_part(self, ADAPT_TRY_LEVEL);
    }
    skip_what_has_no_room(self);
    if (self->goal.accel_limit_pct != 0 && self->free_rms_um_s2 == 0) {
        self->is_free = true;
        wait_for(self, ADAPT_TRYING, 2u * self->cfg.settle_ticks);
    } else if (self->part == ADAPT_TRY_NOTHING) {
        rest(self);
    } else {
        const bool is_start = self->part == ADAPT_TRY_EDGES && self->size == ADAPT_FIRST;
        self->size = is_start && is_noisy(self) ? ADAPT_LARGE : self->size;
        wait_for(self, ADAPT_TRYING, self->cfg.settle_ticks);
    }
}

// A whole pulse or a level is better.
static void keep(adapt_t *self) {
    const adapt_trim_t now = changed(self, self->trim[self->nearest]);
    for (uint32_t i = 0; i < 2u; i++) {
        adapt_trim_t *point = &self->trim[self->index + i];
        if (self->part == ADAPT_TRY_WHOLE) { // at both: between them it is as at the nearer one
            point->value[ADAPT_WHOLE] = now.value[ADAPT_WHOLE];
        } else {
            point->value[ADAPT_LEVEL] = changed(self, *point).value[ADAPT_LEVEL];
        }
    }
    self->gains = increment_sat_u32(self->gains);
    go_on(self);
    self->before = self->trial;
    self->failures = 0;
    if (self->part == ADAPT_TRY_WHOLE) {
        start_part(self, ADAPT_TRY_EDGES);
    }
}

static void move_edges(adapt_t *self, adapt_move_t move) {
    for (uint32_t i = 0; i < 2u; i++) {
        adapt_trim_t *point = &self->trim[self->index + i];
        self->from[i] = (adapt_edges_t){point->value[ADAPT_ON_EDGE], point->value[ADAPT_OFF_EDGE]};
        change_edges(self, point, move);
    }
    self->moved_index = self->index;
    self->move = move;
    self->gains = increment_sat_u32(self->gains);
}

// The move without an edge that is at its limit.
static adapt_move_t within_limits(const adapt_t *self, adapt_move_t move) {
    const int16_t *now = self->trim[self->nearest].value;
    if (move.on * now[ADAPT_ON_EDGE] >= self->cfg.edge_limit_q16) {
        move.on = 0;
    }
    if (move.off * now[ADAPT_OFF_EDGE] >= self->cfg.edge_limit_q16) {
        move.off = 0;
    }
    return move;
}

// Where the frequency lies on a point, the point below it may have become the next one meanwhile.
static void move_back(adapt_t *self) {
    for (uint32_t i = 0; i < 2u && gap_u32(self->moved_index, self->index) <= 1u; i++) {
        int16_t *value = self->trim[self->moved_index + i].value;
        value[ADAPT_ON_EDGE] = self->from[i].on;
        value[ADAPT_OFF_EDGE] = self->from[i].off;
    }
    self->moved_index = NOWHERE;
}

static int32_t drift_q20(const adapt_t *self, adapt_effect_t now) {
    return abs_i32(adapt_drift_q20(self->before, now));
}

// The same pulse reaches farther or less far than before: so would no current. Another trial
// without current for every change of the excitation would be one too many.
static void follow_excitation(adapt_t *self, adapt_effect_t now) {
    const int64_t more_um_s2 =
        ((int64_t)self->free_rms_um_s2 * adapt_drift_q20(self->before, now)) >> 20;
    if (self->free_rms_um_s2 != 0) {
        self->free_rms_um_s2 =
            (uint32_t)clamp_i64(self->free_rms_um_s2 + more_um_s2, 1, UINT32_MAX);
    }
    self->before = now;
}

// The trial lies between two measurements without its change.
static void judge_trial(adapt_t *self, adapt_effect_t after) {
    const int32_t change_q20 = drift_q20(self, after);
    // What two measurements of the same differ by is no gain.
    const int32_t gain_q20 = GAIN_q20 + change_q20;
    self->trials = increment_sat_u32(self->trials);
    if (change_q20 > DISTURBED_q20) {
        follow_excitation(self, after);
    } else if (cost_q20(self, after, self->trial) < -gain_q20 &&
               cost_q20(self, self->before, self->trial) < -gain_q20) {
        keep(self);
    } else {
        self->before = after;
        fail(self);
    }
    try_next(self);
}

// Whether more rounds would tell more than a move is worth.
static bool is_sure(const adapt_t *self) {
    return self->square.rounds == ADAPT_MOST_ROUNDS ||
           adapt_square_chance_q20(&self->square, self->noise_q20) <= GAIN_q20 ||
           adapt_square_hope_q20(&self->square, self->noise_q20) <= 2 * GAIN_q20;
}

// Whether large steps would cost more than what they tell is worth: four times as much as small
// ones.
static bool is_steep(const adapt_t *self) {
    return adapt_square_bend_q20(&self->square) > STEEP_q20;
}

// Steps of this size gain nothing: others, or the next part.
static void end_size(adapt_t *self) {
    if (self->size == ADAPT_FIRST && !is_steep(self)) {
        resize(self, ADAPT_LARGE);
    } else if (self->size == ADAPT_LARGE && !is_noisy(self) &&
               adapt_square_hope_q20(&self->square, self->noise_q20) > 2 * GAIN_q20) {
        resize(self, ADAPT_LAST);
    } else {
        start_part(self, self->part + 1u);
    }
}

// Something else has changed meanwhile, or a corner upsets the vibration for long: then, too, the
// steps are too large.
static void repeat_round(adapt_t *self) {
    adapt_square_restart(&self->square);
    self->failures++;
    if (self->failures >= LOST_CORNERS) {
        shrink(self);
    }
    try_next(self);
}

static void make_move(adapt_t *self, adapt_move_t move, bool is_again) {
    move_edges(self, move);
    self->is_again = is_again;
    wait_for(self, ADAPT_CHECKING, self->cfg.settle_ticks);
}

// The corners lie between two measurements of the centre.
static void judge_corners(adapt_t *self, adapt_effect_t after) {
    self->trials = increment_sat_u32(self->trials);
    if (drift_q20(self, after) > DISTURBED_q20 + self->noise_q20) {
        follow_excitation(self, after);
        repeat_round(self);
        return;
    }
    adapt_square_close(&self->square, cost_q20(self, self->before, after));
    self->before = after;
    const adapt_move_t wanted = adapt_square_move(&self->square, self->noise_q20, GAIN_q20);
    const adapt_move_t move = within_limits(self, adapt_square_forward(&self->square, wanted));
    if (adapt_is_move(move)) {
        const bool may_grow = self->size == ADAPT_FIRST && !is_steep(self);
        self->doubt_q20 = GAIN_q20 + self->noise_q20 + self->square.unsteady_q20;
        make_move(self, move, false);
        adapt_square_moved(&self->square, move);
        self->size = may_grow ? ADAPT_LARGE : self->size;
        return;
    }
    if (adapt_is_move(wanted) || self->failures >= LOST_CORNERS) {
        shrink(self);
    } else if (is_sure(self)) {
        end_size(self);
    }
    self->failures = 0;
    try_next(self);
}

// The last move measures worse than what was before it. Where it had already gained once, the
// corners are tried again from there.
static void undo_move(adapt_t *self) {
    move_back(self);
    if (self->is_again) {
        try_next(self);
    } else {
        shrink(self);
        wait_for(self, ADAPT_MEASURING, self->cfg.settle_ticks);
    }
}

// After a move. A first one has the word of all corners, so that it must be clearly worse to be
// undone; one that gains is made again (Hooke and Jeeves, Journal of the ACM 8, 1961).
static void judge_move(adapt_t *self, adapt_effect_t now) {
    const int32_t cost = cost_q20(self, self->before, now);
    if (cost > (self->is_again ? 0 : GAIN_q20 + 2 * self->noise_q20)) {
        undo_move(self);
        return;
    }
    if (cost < -STEEP_q20) {
        go_on(self);
    }
    self->before = now;
    const adapt_move_t again = within_limits(self, self->move);
    if (cost < -self->doubt_q20 && adapt_is_move(again)) {
        make_move(self, again, true);
        self->square.last = (adapt_move_t){0, 0}; // it may go too far with one of the edges
    } else {
        try_next(self);
    }
}

static void take_free(adapt_t *self, adapt_effect_t effect) {
    self->is_free = false;
    self->free_rms_um_s2 = effect.rms_um_s2 | 1u;
    try_next(self);
}

// A corner's cost, or that of a trial: unless it is clearly worse it is checked.
static void take_trial(adapt_t *self, adapt_effect_t effect) {
    const int32_t cost = cost_q20(self, self->before, effect);
    if (self->part == ADAPT_TRY_EDGES) {
        adapt_square_take(&self->square, cost);
        const bool is_last = self->square.corner == ADAPT_CORNERS;
        wait_for(self, is_last ? ADAPT_CHECKING : ADAPT_TRYING, self->cfg.settle_ticks);
    } else if (cost <= CLEARLY_WORSE_q20) {
        self->trial = effect;
        wait_for(self, ADAPT_CHECKING, self->cfg.settle_ticks);
    } else {
        self->trials = increment_sat_u32(self->trials);
        fail(self);
        // It may be worse because something else has changed: what comes next is judged anew.
        wait_for(self, ADAPT_MEASURING, self->cfg.settle_ticks);
    }
}

// 5/8 of what both parts differ by, on average: their mean's standard deviation. Parts are as long
// as it wants them.
static void note_noise(adapt_t *self, int32_t apart_q20) {
    self->noise_q20 += (apart_q20 * 5 / 8 - self->noise_q20) >> NOISE_SHIFT;
    if (self->noise_q20 > GAIN_q20 && self->longer_log2 < LONGEST_LOG2) {
        self->longer_log2++;
        self->noise_q20 = self->noise_q20 * SQRT_HALF_q8 / 256;
    } else if (self->noise_q20 < GAIN_q20 / 2 && self->longer_log2 > 0) {
        self->longer_log2--;
        self->noise_q20 = self->noise_q20 * SQRT_HALF_q8 / 128;
    }
}

static void conclude(adapt_t *self) {
    const adapt_effect_t effect = adapt_meter_effect(&self->meter);
    if (self->is_free) {
        take_free(self, effect);
    } else if (self->state == ADAPT_TRYING) {
        take_trial(self, effect);
    } else if (self->square.corner == ADAPT_CORNERS) {
        judge_corners(self, effect);
    } else if (self->state == ADAPT_CHECKING && self->part == ADAPT_TRY_EDGES) {
        judge_move(self, effect);
    } else if (self->state == ADAPT_CHECKING) {
        judge_trial(self, effect);
    } else {
        if (drift_q20(self, effect) > DISTURBED_q20) {
            forget_free(self);
        }
        self->freq_mHz = self->now_mHz; // at first the lock may still have been settling
        self->before = effect;
        try_next(self);
    }
}

// Both last parts agree, or it has been measured for as long as is allowed.
static bool is_measured(const adapt_t *self, int32_t apart_q20) {
    const uint32_t most_parts = 1u << (PARTS_LOG2 - self->longer_log2);
    return apart_q20 <= GAIN_q20 + 2 * self->noise_q20 || self->meter.taken >= most_parts;
}

static void compare_parts(adapt_t *self) {
    const int32_t apart_q20 = abs_i32(cost_q20(self, self->meter.part[0], self->meter.part[1]));
    if (is_measured(self, apart_q20)) {
        note_noise(self, apart_q20);
        self->is_due = true;
    } else {
        adapt_meter_go_on(&self->meter);
    }
}

// A tick compares the parts, the next one judges.
static void measure(adapt_t *self, const adapt_in_t *in) {
    const uint32_t part_ticks = (self->cfg.measure_ticks << self->longer_log2) >> PARTS_LOG2;
    if (self->is_due) {
        conclude(self);
    } else if (adapt_meter_step(&self->meter, in->half, part_ticks)) {
        compare_parts(self);
    }
}

// Where the lock does not hold without current, no more acceleration than now.
static void give_free_up(adapt_t *self) {
    self->is_free = false;
    self->free_failures++;
    if (self->free_failures >= FREE_TRIALS) {
        self->free_rms_um_s2 = self->before.rms_um_s2 | 1u;
    }
}

// A trial that loses the lock is not tried again at once: what it changes may be why. Neither is a
// whole pulse, whose current may be why the output was taken away.
void adapt_pause(adapt_t *self, bool has_lost_lock) {
    if (self->state == ADAPT_WAITING) {
        return;
    }
    const bool is_own_fault = has_lost_lock || self->part == ADAPT_TRY_WHOLE;
    if (self->is_free) {
        give_free_up(self);
    } else if (self->state == ADAPT_TRYING && self->part != ADAPT_TRY_EDGES && is_own_fault) {
        self->trials = increment_sat_u32(self->trials);
        fail(self);
    } else if (self->state == ADAPT_TRYING && self->part == ADAPT_TRY_EDGES && has_lost_lock) {
        adapt_square_take(&self->square, LOST_q20);
        self->failures++;
    } else if (has_lost_lock && (self->state == ADAPT_MEASURING || self->state == ADAPT_CHECKING)) {
        move_back(self);
    }
    wait_for(self, ADAPT_WAITING, 0);
}

// The lock's frequency has just been found, or is a half cycle older.
static void follow_freq(adapt_t *self, const adapt_in_t *in) {
    if (self->state == ADAPT_WAITING) {
        self->now_mHz = in->freq_mHz;
    } else if (in->half != NULL) {
        self->now_mHz += (uint32_t)((int32_t)(in->freq_mHz - self->now_mHz) / FREQ_MEAN);
    }
}

void adapt_aim(adapt_t *self, const adapt_aim_t *aim) {
    self->goal = aim->goal;
    self->index = (uint8_t)aim->index;
    self->nearest = (uint8_t)(aim->index + (aim->part_q16 >= HALF_q16 ? 1u : 0u));
}

void adapt_step(adapt_t *self, const adapt_in_t *in) {
    follow_freq(self, in);
    self->left_ticks -= self->left_ticks > 0 && self->state != ADAPT_RESTING ? 1u : 0u;
    if (!in->may_try) {
        adapt_pause(self, false);
    } else if (self->state == ADAPT_WAITING) {
        wait_for(self, ADAPT_MEASURING, self->cfg.settle_ticks);
    } else if (self->ticks > 0 && !(self->state == ADAPT_RESTING && has_moved(self))) {
        self->ticks--;
    } else if (has_moved(self)) {
        // It may be what is tried: then the frequency comes back.
        if (self->state == ADAPT_TRYING) {
            adapt_pause(self, true);
        } else {
            start_search(self);
        }
    } else if (self->state == ADAPT_RESTING) {
        wait_for(self, ADAPT_MEASURING, 0);
    } else {
        measure(self, in);
    }
}

adapt_trim_t adapt_trim_at(const adapt_t *self, uint32_t index, uint32_t part_q16) {
    adapt_trim_t trim;
    for (uint32_t i = 0; i < ADAPT_COORDINATES; i++) {
        const int32_t from = self->trim[index].value[i];
        const int32_t rise = self->trim[index + 1u].value[i] - from;
        trim.value[i] = (int16_t)(from + ((rise * (int32_t)(part_q16 >> 1) + HALF_q15) >> 15));
    }
    return self->state == ADAPT_TRYING ? changed(self, trim) : trim;
}

bool adapt_is_allowed(const adapt_cfg_t *cfg, const adapt_trim_t *trim) {
    for (uint32_t i = 0; i < ADAPT_COORDINATES; i++) {
        if (limited(cfg, i, trim->value[i]) != trim->value[i]) {
            return false;
        }
    }
    return true;
}
