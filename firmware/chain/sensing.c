#include "sensing.h"

#include <stddef.h>

#include "at_start.h"
#include "view_signal.h"

// Bits of a quantity of a body or damper.
static uint64_t bit(uint64_t quantity, int32_t at) {
    return quantity << at;
}

// Likewise, of motion and strokes, which are in the low word.
static uint32_t low_bit(uint64_t quantity, int32_t at) {
    return (uint32_t)quantity << at;
}

_Static_assert(QUIESCE_VALID_STROKE_VELOCITY + QUIESCE_MAX_DAMPERS <= 32,
               "motion and strokes are in the low word");

// Counts of a board; constants where the build has one of them.
static int32_t sensors_of(const places_t *self) {
    return QUIESCE_SENSORS == 1 ? 1 : self->sensors;
}

static int32_t dampers_of(const places_t *self) {
    return QUIESCE_DAMPERS == 1 ? 1 : self->dampers;
}

// Of those that are no accelerometers; the only sensor is one.
static uint32_t measured_of_bodies(const places_t *self) {
    return QUIESCE_SENSORS == 1 ? 0 : self->of_bodies;
}

static uint32_t measured_in_all(const places_t *self) {
    return QUIESCE_SENSORS == 1 ? 0 : self->of_all;
}

static bool is_accelerometer(sensor_place_t sensor) {
    return QUIESCE_SENSORS == 1 || sensor.sense == QUIESCE_SENSE_ACCEL;
}

// Ends of a damper; with one body there is the ground only beside it.
static int32_t end_a_of(damper_place_t damper) {
    return QUIESCE_BODIES == 1 ? 0 : damper.end_a;
}

static int32_t end_b_of(damper_place_t damper) {
    return QUIESCE_BODIES == 1 ? QUIESCE_GROUND : damper.end_b;
}

// Ceiling: a sample is late only after the longest gap between two of them. A tick is a whole
// number of microseconds.
static uint32_t period_ticks(int32_t period_us, uint32_t tick_rate_Hz) {
    const int32_t tick_us = 1000000 / (int32_t)tick_rate_Hz;
    return period_us == 0 ? 1u : ticks_in_us(period_us + tick_us - 1, tick_rate_Hz);
}

static uint32_t at_least_one(uint32_t value) {
    return value > 0 ? value : 1u;
}

// A time that is shorter than two samples must not switch the check off, nor make a fault of each.
static uint32_t stuck_samples(int32_t stuck_us, uint32_t tick_rate_Hz, uint32_t period_ticks) {
    const uint32_t samples = ticks_in_us(stuck_us, tick_rate_Hz) / period_ticks;
    return stuck_us == 0 ? 0 : samples < 2u ? 2u : samples;
}

static void channel_init(channel_t *self, const quiesce_board_sensor_t *sensor,
                         const quiesce_params_t *p, bool is_accel) {
    const uint32_t rate_Hz = (uint32_t)p->tick_rate_Hz;
    const uint32_t period = period_ticks(sensor->period_us, rate_Hz);
    condition_init(&self->condition,
                   &(condition_cfg_t){
                       .tick_rate_Hz = rate_Hz,
                       .scale = sensor->scale,
                       .limit = is_accel ? CONDITION_ACCEL_LIMIT_um_s2 : VIEW_LIMIT,
                       .period_ticks = period,
                       .most_lost_q16 = sensor->max_lost_pct * 65536 / 100, // floor
                       .offset_counts = sensor->offset_counts,
                       .polarity = sensor->polarity,
                       .full_scale_counts = sensor->full_scale_counts,
                       .max_age_ticks = at_least_one(ticks_in_us(sensor->max_age_us, rate_Hz)),
                       .stuck_ticks = stuck_samples(sensor->stuck_us, rate_Hz, period),
                       .min_noise_counts = (uint32_t)sensor->min_noise_counts,
                       .dc_cutoff_mHz = is_accel ? p->dc_cutoff_mHz : 0,
                   });
    motion_init(&self->motion, rate_Hz, p->velocity_cutoff_mHz);
    position_init(&self->position, rate_Hz, p->velocity_cutoff_mHz);
}

static sensor_place_t place_of(const quiesce_board_sensor_t *sensor) {
    const view_quantity_t *quantity = &view_quantity[sensor->sense];
    return (sensor_place_t){
        .sense = (uint8_t)sensor->sense,
        .at = (uint8_t)sensor->at,
        .offset = (uint16_t)(quantity->offset + quantity->stride * (uint32_t)sensor->at),
        .bit = UINT64_C(1) << (quantity->valid + (uint32_t)sensor->at),
    };
}

// Appends those of bodies, or all others but the accelerometers. Returns how many there are then.
static uint8_t list_measured(places_t *self, bool of_bodies, uint8_t count) {
    for (int32_t i = 0; i < sensors_of(self); i++) {
        const sensor_place_t sensor = self->sensor[i];
        if (!is_accelerometer(sensor) && quiesce_sense_is_of_body(sensor.sense) == of_bodies) {
            self->measured[count++] = (uint8_t)i;
        }
    }
    return count;
}

void places_init(places_t *self, const quiesce_board_t *board) {
    *self = (places_t){
        .sensors = (uint8_t)board->sensors,
        .bodies = (uint8_t)board->bodies,
        .dampers = (uint8_t)board->dampers,
    };
    for (int32_t i = 0; i < sensors_of(self); i++) {
        self->sensor[i] = place_of(&board->sensor[i]);
    }
    self->of_bodies = list_measured(self, true, 0);
    self->of_all = list_measured(self, false, self->of_bodies);
    for (int32_t i = 0; i < dampers_of(self); i++) {
        const quiesce_board_damper_t *damper = &board->damper[i];
        self->damper[i] = (damper_place_t){(uint8_t)damper->end_a, (uint8_t)damper->end_b};
    }
}

AT_START void sensing_init(sensing_t *self, const quiesce_board_t *board,
                           const quiesce_params_t *params, uint64_t needs) {
    const uint64_t strokes = VIEW_EACH(VIEW_STROKE) | VIEW_EACH(VIEW_STROKE_VELOCITY);
    places_init(&self->places, board);
    self->has_strokes = (needs & strokes) != 0;
    self->has_displacements =
        board->bodies > 1 || (needs & (VIEW_EACH(VIEW_DISPLACEMENT) | strokes)) != 0;
    for (int32_t i = 0; i < sensors_of(&self->places); i++) {
        channel_init(&self->channel[i], &board->sensor[i], params,
                     is_accelerometer(self->places.sensor[i]));
    }
}

// um/s, away from 0: never 0 where the state is not.
static int32_t velocity_away_um_s(int64_t velocity_um_s_q32) {
    const int32_t floor_um_s = motion_velocity_um_s(velocity_um_s_q32);
    const bool has_part = (uint32_t)velocity_um_s_q32 != 0;
    return floor_um_s + (floor_um_s >= 0 && has_part ? 1 : 0);
}

static bool is_inside(int32_t value, int32_t limit) {
    return value > -limit && value < limit;
}

static void show_displacement(channel_t *self, int32_t at, view_t *view) {
    view_body_t *body = &view->body[at];
    body->displacement_nm = position_step(&self->position, self->motion.velocity_um_s_q32);
    if (((uint32_t)view->valid & low_bit(VIEW_VELOCITY, at)) != 0 &&
        is_inside(body->displacement_nm, VIEW_LIMIT)) {
        view->valid |= low_bit(VIEW_DISPLACEMENT, at);
    }
}

static void show_acceleration(channel_t *self, int32_t at, view_t *view) {
    const int32_t accel_um_s2 = self->sample.value;
    if (self->sample.is_fault) {
        // What was taken in before the fault was seen must not outlive it.
        motion_reset(&self->motion);
        position_reset(&self->position);
    }
    const int64_t velocity_um_s_q32 = motion_step(&self->motion, accel_um_s2);
    const int32_t velocity_um_s = velocity_away_um_s(velocity_um_s_q32);
    view->body[at].accel_um_s2 = accel_um_s2;
    view->body[at].velocity_um_s = velocity_um_s;
    if (self->condition.has_value) {
        view->valid |=
            (is_inside(accel_um_s2, CONDITION_ACCEL_LIMIT_um_s2) ? low_bit(VIEW_ACCEL, at) : 0) |
            (is_inside(velocity_um_s, VIEW_LIMIT) ? low_bit(VIEW_VELOCITY, at) : 0);
    }
}

// What is measured replaces what was computed, also where it is not valid now.
static void show_measured(const channel_t *self, const sensor_place_t *sensor, view_t *view) {
    const int32_t value = self->sample.value;
    *(int32_t *)(void *)((uint8_t *)view + sensor->offset) = value;
    if (self->condition.has_value && is_inside(value, VIEW_LIMIT)) {
        view->valid |= sensor->bit;
    } else {
        view->valid &= ~sensor->bit;
    }
}

// Whether a quantity of both ends is valid; the ground's always is.
static bool is_known_of_both(const view_t *view, damper_place_t damper, uint64_t quantity) {
    const uint32_t ends =
        low_bit(quantity, end_a_of(damper)) |
        (end_b_of(damper) == QUIESCE_GROUND ? 0 : low_bit(quantity, end_b_of(damper)));
    return ((uint32_t)view->valid & ends) == ends;
}

static void show_stroke(damper_place_t damper, int32_t i, view_t *view) {
    const view_body_t *a = &view->body[end_a_of(damper)];
    view_damper_t *out = &view->damper[i];
    out->stroke_nm = a->displacement_nm;
    out->velocity_um_s = a->velocity_um_s;
    if (end_b_of(damper) != QUIESCE_GROUND) {
        const view_body_t *b = &view->body[end_b_of(damper)];
        out->stroke_nm = clamp_i32(out->stroke_nm - b->displacement_nm, -VIEW_LIMIT, VIEW_LIMIT);
        out->velocity_um_s =
            clamp_i32(out->velocity_um_s - b->velocity_um_s, -VIEW_LIMIT, VIEW_LIMIT);
    }
    const bool has_stroke = is_known_of_both(view, damper, VIEW_DISPLACEMENT);
    const bool has_velocity = is_known_of_both(view, damper, VIEW_VELOCITY);
    view->valid |=
        (has_stroke && is_inside(out->stroke_nm, VIEW_LIMIT) ? low_bit(VIEW_STROKE, i) : 0) |
        (has_velocity && is_inside(out->velocity_um_s, VIEW_LIMIT)
             ? low_bit(VIEW_STROKE_VELOCITY, i)
             : 0);
}

// Those of the list from first on.
static void show_all_measured(const sensing_t *self, uint32_t first, uint32_t end, view_t *view) {
    for (uint32_t i = first; i < end; i++) {
        const uint8_t number = self->places.measured[i];
        show_measured(&self->channel[number], &self->places.sensor[number], view);
    }
}

static void show_of_dampers(const sensing_t *self, view_t *view) {
    show_all_measured(self, measured_of_bodies(&self->places), measured_in_all(&self->places),
                      view);
}

static void show_strokes(const sensing_t *self, view_t *view) {
    for (int32_t i = 0; i < dampers_of(&self->places); i++) {
        show_stroke(self->places.damper[i], i, view);
    }
}

void sensing_show_strokes(const sensing_t *self, view_t *view) {
    if (self->has_displacements && !self->has_strokes) {
        show_strokes(self, view);
        show_of_dampers(self, view);
    }
}

void sensing_step(sensing_t *self, const quiesce_sample_t samples[QUIESCE_SENSORS], view_t *view) {
    // A current that is not measured is computed.
    view->valid = VIEW_CURRENT * ((UINT64_C(1) << dampers_of(&self->places)) - 1u);
    for (int32_t i = 0; i < sensors_of(&self->places); i++) {
        channel_t *channel = &self->channel[i];
        const condition_in_t in = {samples[i].counts, samples[i].is_fresh, samples[i].is_saturated};
        condition_step(&channel->condition, &in, &channel->sample);
        if (is_accelerometer(self->places.sensor[i])) {
            const int32_t at = QUIESCE_BODIES == 1 ? 0 : self->places.sensor[i].at;
            show_acceleration(channel, at, view);
            if (self->has_displacements) {
                show_displacement(channel, at, view);
            }
        }
    }
    show_all_measured(self, 0, measured_of_bodies(&self->places), view);
    if (self->has_strokes) {
        show_strokes(self, view);
    }
    show_of_dampers(self, view);
}

uint64_t places_provide(const places_t *self) {
    view_t known = {.valid = VIEW_RMS | VIEW_TONE | VIEW_LOCK};
    uint64_t measured = 0;
    for (int32_t i = 0; i < sensors_of(self); i++) {
        const sensor_place_t sensor = self->sensor[i];
        if (is_accelerometer(sensor)) {
            known.valid |= bit(VIEW_ACCEL | VIEW_VELOCITY | VIEW_DISPLACEMENT, sensor.at);
        } else {
            measured |= sensor.bit;
        }
    }
    known.valid |= measured;
    uint64_t provided = known.valid;
    for (int32_t i = 0; i < dampers_of(self); i++) {
        const damper_place_t damper = self->damper[i];
        provided |= bit(VIEW_CURRENT, i);
        provided |= is_known_of_both(&known, damper, VIEW_DISPLACEMENT) ? bit(VIEW_STROKE, i) : 0;
        provided |=
            is_known_of_both(&known, damper, VIEW_VELOCITY) ? bit(VIEW_STROKE_VELOCITY, i) : 0;
    }
    return provided;
}
