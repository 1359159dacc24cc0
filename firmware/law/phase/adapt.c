#include "adapt.h"

enum {
    EDGE_STEP_q16 = 4369,      // 12 degrees
    LEVEL_STEP_q15 = 4915,     // 15 %
    SHRINK_LAST = 2,           // to 3 degrees and 2.5 %
    GAIN_q20 = 2097,           // 0.2 %: less is not worth a move
    DISTURBED_q20 = 20972,     // 2 %
    CLEARLY_WORSE_q20 = 10486, // 1 %
    DRIFT_DIVISOR = 50,        // of the frequency: 2 %
    DIRECTIONS = 2,
    HALF_q15 = 1 << 14,
    HALF_q16 = 1 << 15,
};

void adapt_init(adapt_t *self, const adapt_cfg_t *cfg) {
    *self = (adapt_t){.cfg = *cfg, .direction = 1};
}

void adapt_clear(adapt_t *self) {
    const adapt_cfg_t cfg = self->cfg;
    adapt_init(self, &cfg);
}

static void wait_for(adapt_t *self, adapt_state_t state, uint32_t ticks) {
    self->state = state;
    self->ticks = ticks;
    adapt_meter_reset(&self->meter);
}

static bool has_moved(const adapt_t *self, uint32_t freq_mHz) {
    return gap_u32(freq_mHz, self->freq_mHz) > self->freq_mHz / DRIFT_DIVISOR;
}

// The vibration is another one: it must last before the search starts, with large steps.
static void start_search_at(adapt_t *self, uint32_t freq_mHz) {
    self->freq_mHz = freq_mHz;
    self->coordinate = ADAPT_WHOLE;
    self->direction = 1;
    self->shrink = 0;
    self->barren = 0;
    self->failures = 0;
    self->has_tried_whole = false;
    self->is_exhausted = false;
    wait_for(self, ADAPT_MEASURING, self->cfg.start_ticks);
}

// change / from in Q20, limited to something between a quarter and a half, to 2^-9 of itself; one
// 32-bit division.
static int32_t relative_q20(uint32_t from, int64_t change) {
    const uint32_t up = (uint32_t)__builtin_clz(from | 1u);
    const int64_t limited_change = clamp_i64(change * (INT64_C(1) << up) >> 2, -(1 << 28), 1 << 28);
    return (int32_t)limited_change / (int32_t)(((from | 1u) << up) >> 22);
}

static int64_t excess_um_s2(adapt_effect_t effect, uint32_t shape_q14) {
    const int64_t free_um_s2 = (int64_t)(((uint64_t)effect.reach_um_s2 * shape_q14) >> 14);
    return clamp_i64(effect.rms_um_s2 - free_um_s2, 0, INT32_MAX);
}

static int32_t cost_q20(adapt_effect_t from, adapt_effect_t to, adapt_goal_t goal) {
    const int64_t excess =
        excess_um_s2(to, goal.accel_shape_q14) - excess_um_s2(from, goal.accel_shape_q14);
    const int64_t accel_q20 = relative_q20(from.rms_um_s2, excess);
    return relative_q20(from.reach_um_s2, (int64_t)to.reach_um_s2 - from.reach_um_s2) +
           (int32_t)((accel_q20 * goal.accel_weight_q8) >> 8);
}

static int32_t step_of(const adapt_t *self) {
    switch (self->coordinate) {
    case ADAPT_WHOLE:
        return self->direction;
    case ADAPT_LEVEL:
        return self->direction * (LEVEL_STEP_q15 >> self->shrink);
    default:
        return self->direction * (EDGE_STEP_q16 >> self->shrink);
    }
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

// What costs much where it does not help is tried at the beginning of a search only: the pulse
// without its gap once, a lower level with large steps.
static bool is_too_late(const adapt_t *self) {
    const int16_t *now = self->trim[self->nearest].value;
    switch (self->coordinate) {
    case ADAPT_WHOLE:
        return self->has_tried_whole && now[ADAPT_WHOLE] == 0;
    case ADAPT_LEVEL:
        return self->shrink == SHRINK_LAST && now[ADAPT_LEVEL] == 0;
    default:
        return now[ADAPT_WHOLE] != 0; // there are no edges to move
    }
}

// Whether a trial would change anything.
static bool has_room(const adapt_t *self) {
    const int32_t value = self->trim[self->nearest].value[self->coordinate];
    return !is_too_late(self) &&
           limited(&self->cfg, self->coordinate, value + step_of(self)) != value;
}

static void next_coordinate(adapt_t *self) {
    self->failures = 0;
    self->coordinate = (self->coordinate + 1u) % ADAPT_COORDINATES;
    self->barren++;
    if (self->barren < ADAPT_COORDINATES) {
        return;
    }
    self->barren = 0;
    self->is_exhausted = self->shrink == SHRINK_LAST;
    self->shrink += self->shrink < SHRINK_LAST ? 1u : 0u;
}

// One direction gains nothing: the other one, then the next coordinate.
static void fail(adapt_t *self) {
    self->direction = -self->direction;
    self->failures++;
    if (self->failures >= DIRECTIONS) {
        next_coordinate(self);
    }
}

// A trial that is not checked.
static void give_up(adapt_t *self) {
    self->trials = increment_sat_u32(self->trials);
    fail(self);
}

static void try_next(adapt_t *self) {
    for (uint32_t i = 0; i < DIRECTIONS * ADAPT_COORDINATES && !has_room(self); i++) {
        fail(self);
    }
    if (self->is_exhausted) {
        self->is_exhausted = false;
        wait_for(self, ADAPT_RESTING, self->cfg.rest_ticks);
    } else {
        self->has_tried_whole |= self->coordinate == ADAPT_WHOLE;
        wait_for(self, ADAPT_TRYING, self->cfg.settle_ticks);
    }
}

static void keep(adapt_t *self) {
    for (uint32_t i = self->index; i <= self->index + 1u && i < ADAPT_POINTS; i++) {
        int16_t *value = &self->trim[i].value[self->coordinate];
        // A gap is closed or open at both points: between them it is as at the nearer one.
        const int32_t from = self->coordinate == ADAPT_WHOLE ? 0 : *value;
        *value = (int16_t)limited(&self->cfg, self->coordinate, from + step_of(self));
    }
    self->gains = increment_sat_u32(self->gains);
    self->barren = 0;
    self->failures = 0;
    self->before = self->trial;
}

// The trial lies between two measurements without its change.
static void judge(adapt_t *self, adapt_goal_t goal) {
    const adapt_effect_t after = self->meter.effect;
    const int32_t drift_q20 = abs_i32(relative_q20(
        self->before.reach_um_s2, (int64_t)after.reach_um_s2 - self->before.reach_um_s2));
    // What two measurements of the same differ by is no gain.
    const int32_t gain_q20 = GAIN_q20 + drift_q20;
    self->trials = increment_sat_u32(self->trials);
    if (drift_q20 > DISTURBED_q20) {
        self->before = after;
    } else if (cost_q20(after, self->trial, goal) < -gain_q20 &&
               cost_q20(self->before, self->trial, goal) < -gain_q20) {
        keep(self);
    } else {
        self->before = after;
        fail(self);
    }
}

static void conclude(adapt_t *self, adapt_goal_t goal) {
    switch (self->state) {
    case ADAPT_TRYING:
        self->trial = self->meter.effect;
        if (cost_q20(self->before, self->trial, goal) <= CLEARLY_WORSE_q20) {
            wait_for(self, ADAPT_CHECKING, self->cfg.settle_ticks);
            return;
        }
        give_up(self);
        // It may be worse because something else has changed: what comes next is judged anew.
        wait_for(self, ADAPT_MEASURING, self->cfg.settle_ticks);
        return;
    case ADAPT_CHECKING:
        judge(self, goal);
        break;
    default:
        self->before = self->meter.effect;
        break;
    }
    try_next(self);
}

static void measure(adapt_t *self, const adapt_in_t *in) {
    if (adapt_meter_step(&self->meter, in->half, self->cfg.measure_ticks)) {
        conclude(self, in->goal);
    }
}

// A trial that ends like this is not tried again at once: it may be what ended it.
void adapt_pause(adapt_t *self) {
    if (self->state == ADAPT_TRYING) {
        give_up(self);
    }
    wait_for(self, ADAPT_WAITING, 0);
}

void adapt_step(adapt_t *self, const adapt_in_t *in) {
    self->index = in->index;
    self->nearest = in->index + (in->part_q16 >= HALF_q16 ? 1u : 0u);
    if (!in->may_try) {
        adapt_pause(self);
    } else if (self->state == ADAPT_WAITING) {
        wait_for(self, ADAPT_MEASURING, self->cfg.settle_ticks);
    } else if (self->ticks > 0 &&
               !(self->state == ADAPT_RESTING && has_moved(self, in->freq_mHz))) {
        self->ticks--;
    } else if (has_moved(self, in->freq_mHz)) {
        start_search_at(self, in->freq_mHz);
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
        const int32_t change = self->trim[index + 1u].value[i] - from;
        trim.value[i] = (int16_t)(from + ((change * (int32_t)(part_q16 >> 1) + HALF_q15) >> 15));
    }
    if (self->state == ADAPT_TRYING) {
        const int32_t tried = trim.value[self->coordinate] + step_of(self);
        trim.value[self->coordinate] = (int16_t)limited(&self->cfg, self->coordinate, tried);
    }
    return trim;
}

bool adapt_is_allowed(const adapt_cfg_t *cfg, const adapt_trim_t *trim) {
    for (uint32_t i = 0; i < ADAPT_COORDINATES; i++) {
        if (limited(cfg, i, trim->value[i]) != trim->value[i]) {
            return false;
        }
    }
    return true;
}
