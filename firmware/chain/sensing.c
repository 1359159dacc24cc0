#include "sensing.h"

// Bits of a quantity of a body or damper.
static uint64_t bit(uint64_t quantity, int32_t at) {
    return quantity << at;
}

// Counts of a board; constants where the build has one of them.
static int32_t sensors_of(const places_t *self) {
    return QUIESCE_SENSORS == 1 ? 1 : self->sensors;
}

static int32_t dampers_of(const places_t *self) {
    return QUIESCE_DAMPERS == 1 ? 1 : self->dampers;
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

// floor; rates are 500, 1000, 2000 or 4000 Hz.
static uint32_t ticks_in_us(int32_t time_us, int32_t tick_rate_Hz) {
    return (uint32_t)((int64_t)time_us * tick_rate_Hz / 1000000);
}

static uint32_t at_least_one(uint32_t value) {
    return value > 0 ? value : 1u;
}

// A time that is shorter than a sample must not switch the check off.
static uint32_t stuck_samples(int32_t stuck_us, int32_t tick_rate_Hz, uint32_t period_ticks) {
    return stuck_us == 0 ? 0 : at_least_one(ticks_in_us(stuck_us, tick_rate_Hz) / period_ticks);
}

static void channel_init(channel_t *self, const quiesce_board_sensor_t *sensor,
                         const quiesce_params_t *p, bool is_accel) {
    const uint32_t rate_Hz = (uint32_t)p->tick_rate_Hz;
    const uint32_t period = at_least_one(ticks_in_us(sensor->period_us, p->tick_rate_Hz));
    condition_init(
        &self->condition,
        &(condition_cfg_t){
            .tick_rate_Hz = rate_Hz,
            .scale = sensor->scale,
            .limit = is_accel ? CONDITION_ACCEL_LIMIT_um_s2 : VIEW_LIMIT,
            .period_ticks = period,
            .max_lost_pct = (uint32_t)sensor->max_lost_pct,
            .offset_counts = sensor->offset_counts,
            .polarity = sensor->polarity,
            .full_scale_counts = sensor->full_scale_counts,
            .max_age_ticks = at_least_one(ticks_in_us(sensor->max_age_us, p->tick_rate_Hz)),
            .stuck_ticks = stuck_samples(sensor->stuck_us, p->tick_rate_Hz, period),
            .min_noise_counts = (uint32_t)sensor->min_noise_counts,
            .dc_cutoff_mHz = is_accel ? p->dc_cutoff_mHz : 0,
        });
    motion_init(&self->motion, rate_Hz, p->velocity_cutoff_mHz);
    position_init(&self->position, rate_Hz, p->velocity_cutoff_mHz);
}

void places_init(places_t *self, const quiesce_board_t *board) {
    *self = (places_t){
        .sensors = (uint8_t)board->sensors,
        .bodies = (uint8_t)board->bodies,
        .dampers = (uint8_t)board->dampers,
    };
    for (int32_t i = 0; i < sensors_of(self); i++) {
        const quiesce_board_sensor_t *sensor = &board->sensor[i];
        self->sensor[i] = (sensor_place_t){(uint8_t)sensor->sense, (uint8_t)sensor->at};
    }
    for (int32_t i = 0; i < dampers_of(self); i++) {
        const quiesce_board_damper_t *damper = &board->damper[i];
        self->damper[i] = (damper_place_t){(uint8_t)damper->end_a, (uint8_t)damper->end_b};
    }
}

void sensing_init(sensing_t *self, const quiesce_board_t *board, const quiesce_params_t *params,
                  uint64_t needs) {
    const uint64_t strokes =
        VIEW_EACH(VIEW_DISPLACEMENT) | VIEW_EACH(VIEW_STROKE) | VIEW_EACH(VIEW_STROKE_VELOCITY);
    places_init(&self->places, board);
    self->has_strokes = board->bodies > 1 || (needs & strokes) != 0;
    for (int32_t i = 0; i < sensors_of(&self->places); i++) {
        channel_init(&self->channel[i], &board->sensor[i], params,
                     is_accelerometer(self->places.sensor[i]));
    }
}

// um/s, away from 0: never 0 where the state is not.
static int32_t velocity_away_um_s(int64_t velocity_um_s_q32) {
    return motion_velocity_um_s(velocity_um_s_q32 + (velocity_um_s_q32 > 0 ? UINT32_MAX : 0));
}

static bool is_inside(int32_t value, int32_t limit) {
    return value > -limit && value < limit;
}

static void show_displacement(channel_t *self, int32_t at, view_t *view) {
    view_body_t *body = &view->body[at];
    body->displacement_nm = position_step(&self->position, self->velocity_um_s_q32);
    const bool has_velocity = (view->valid & bit(VIEW_VELOCITY, at)) != 0;
    view->valid |= has_velocity && is_inside(body->displacement_nm, VIEW_LIMIT)
                       ? bit(VIEW_DISPLACEMENT, at)
                       : 0;
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
    self->velocity_um_s_q32 = velocity_um_s_q32;
    view->body[at].accel_um_s2 = accel_um_s2;
    view->body[at].velocity_um_s = velocity_um_s;
    if (self->condition.has_value) {
        view->valid |=
            (is_inside(accel_um_s2, CONDITION_ACCEL_LIMIT_um_s2) ? bit(VIEW_ACCEL, at) : 0) |
            (is_inside(velocity_um_s, VIEW_LIMIT) ? bit(VIEW_VELOCITY, at) : 0);
    }
}

static bool is_of_body(sensor_place_t sensor) {
    return sensor.sense <= QUIESCE_SENSE_DISPLACEMENT;
}

typedef struct {
    uint64_t quantity; ///< its first bit
    int32_t *value;
} place_t;

static place_t place_of(sensor_place_t sensor, view_t *view) {
    // A build may have fewer bodies than dampers, or the other way round.
    view_body_t *body = &view->body[is_of_body(sensor) ? sensor.at : 0];
    view_damper_t *damper = &view->damper[is_of_body(sensor) ? 0 : sensor.at];
    switch (sensor.sense) {
    case QUIESCE_SENSE_VELOCITY:
        return (place_t){VIEW_VELOCITY, &body->velocity_um_s};
    case QUIESCE_SENSE_DISPLACEMENT:
        return (place_t){VIEW_DISPLACEMENT, &body->displacement_nm};
    case QUIESCE_SENSE_STROKE:
        return (place_t){VIEW_STROKE, &damper->stroke_nm};
    case QUIESCE_SENSE_STROKE_VELOCITY:
        return (place_t){VIEW_STROKE_VELOCITY, &damper->velocity_um_s};
    case QUIESCE_SENSE_FORCE:
        return (place_t){VIEW_FORCE, &damper->force_mN};
    case QUIESCE_SENSE_VOLTAGE:
        return (place_t){VIEW_VOLTAGE, &damper->voltage_mV};
    case QUIESCE_SENSE_TEMPERATURE:
        return (place_t){VIEW_TEMPERATURE, &damper->temperature_mdegC};
    default:
        return (place_t){VIEW_SUPPLY, &view->supply_mV};
    }
}

// What is measured replaces what was computed, also where it is not valid now.
static void show_measured(const channel_t *self, sensor_place_t sensor, view_t *view) {
    const place_t place = place_of(sensor, view);
    const bool is_valid = self->condition.has_value && is_inside(self->sample.value, VIEW_LIMIT);
    *place.value = self->sample.value;
    view->valid &= ~bit(place.quantity, sensor.at);
    view->valid |= is_valid ? bit(place.quantity, sensor.at) : 0;
}

// Whether a quantity of both ends is valid; the ground's always is.
static bool is_known_of_both(const view_t *view, damper_place_t damper, uint64_t quantity) {
    const uint64_t ends =
        bit(quantity, end_a_of(damper)) |
        (end_b_of(damper) == QUIESCE_GROUND ? 0 : bit(quantity, end_b_of(damper)));
    return (view->valid & ends) == ends;
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
        (has_stroke && is_inside(out->stroke_nm, VIEW_LIMIT) ? bit(VIEW_STROKE, i) : 0) |
        (has_velocity && is_inside(out->velocity_um_s, VIEW_LIMIT) ? bit(VIEW_STROKE_VELOCITY, i)
                                                                   : 0);
}

static void show_all_measured(const sensing_t *self, bool of_bodies, view_t *view) {
    for (int32_t i = 0; i < sensors_of(&self->places); i++) {
        const sensor_place_t sensor = self->places.sensor[i];
        if (!is_accelerometer(sensor) && is_of_body(sensor) == of_bodies) {
            show_measured(&self->channel[i], sensor, view);
        }
    }
}

void sensing_step(sensing_t *self, const quiesce_sample_t samples[QUIESCE_SENSORS], view_t *view) {
    // A current that is not measured is computed.
    view->valid = VIEW_CURRENT * ((UINT64_C(1) << dampers_of(&self->places)) - 1u);
    for (int32_t i = 0; i < sensors_of(&self->places); i++) {
        channel_t *channel = &self->channel[i];
        condition_step(&channel->condition, samples[i].counts, samples[i].is_fresh,
                       &channel->sample);
        if (is_accelerometer(self->places.sensor[i])) {
            const int32_t at = QUIESCE_BODIES == 1 ? 0 : self->places.sensor[i].at;
            show_acceleration(channel, at, view);
            if (self->has_strokes) {
                show_displacement(channel, at, view);
            }
        }
    }
    show_all_measured(self, true, view);
    for (int32_t i = 0; self->has_strokes && i < dampers_of(&self->places); i++) {
        show_stroke(self->places.damper[i], i, view);
    }
    show_all_measured(self, false, view);
}

uint64_t places_provide(const places_t *self) {
    view_t known = {.valid = VIEW_RMS | VIEW_TONE | VIEW_LOCK};
    uint64_t measured = 0;
    for (int32_t i = 0; i < sensors_of(self); i++) {
        const sensor_place_t sensor = self->sensor[i];
        if (is_accelerometer(sensor)) {
            known.valid |= bit(VIEW_ACCEL | VIEW_VELOCITY | VIEW_DISPLACEMENT, sensor.at);
        } else {
            measured |= bit(place_of(sensor, &known).quantity, sensor.at);
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
