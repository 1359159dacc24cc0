// Default and checks of boards.
#include "quiesce_board.h"

#include <stddef.h>

#define HIGHEST_COUNTS 8388607 // 24 bits
#define HIGHEST_SCALE 1000000000
#define LONGEST_us 100000000
#define SCALES_PER_UNIT 1000
#define SLOWEST_NOISE_us 100000
#define HIGHEST_ACCEL_um_s2 500000000
#define HIGHEST_VALUE ((1 << 30) - 1)

static const quiesce_board_sensor_t accelerometer = {
    .sense = QUIESCE_SENSE_ACCEL,
    .axis = 2,
    .polarity = 1,
    .scale = 57751,
    .full_scale_counts = HIGHEST_COUNTS,
    .max_age_us = 10000,
    .stuck_us = 250000,
    .max_lost_pct = 50,
};

static const quiesce_board_damper_t damper_to_ground = {
    .end_b = QUIESCE_GROUND,
    .ceiling_mA = 5000,
    .continuous_mA = 5000,
    .heat_s = 60,
    .coil_lag_us = 5000,
};

void quiesce_board_default(quiesce_board_t *board) {
    *board = (quiesce_board_t){.sensors = 1, .bodies = 1, .dampers = 1};
    board->sensor[0] = accelerometer;
    board->damper[0] = damper_to_ground;
}

typedef struct {
    size_t offset;
    const char *name;
    int32_t min;
    int32_t max;
} range_t;

#define BOARD(field, low, high)                                                                    \
    { offsetof(quiesce_board_t, field), #field, low, high }
#define SENSOR(field, low, high)                                                                   \
    { offsetof(quiesce_board_sensor_t, field), #field, low, high }
#define DAMPER(field, low, high)                                                                   \
    { offsetof(quiesce_board_damper_t, field), #field, low, high }

static const range_t board_ranges[] = {
    BOARD(sensors, 1, QUIESCE_SENSORS), BOARD(bodies, 1, QUIESCE_BODIES),
    BOARD(dampers, 1, QUIESCE_DAMPERS), BOARD(tracked, 0, QUIESCE_SENSORS - 1),
    BOARD(bus_latency_us, 0, 100000),
};

static const range_t sensor_ranges[] = {
    SENSOR(sense, 0, QUIESCE_SENSES - 1),
    SENSOR(at, 0, QUIESCE_MAX_BODIES - 1),
    SENSOR(axis, 0, 2),
    SENSOR(polarity, -1, 1),
    SENSOR(scale, 1, HIGHEST_SCALE),
    SENSOR(offset_counts, -HIGHEST_COUNTS, HIGHEST_COUNTS),
    SENSOR(full_scale_counts, 127, HIGHEST_COUNTS),
    SENSOR(period_us, 0, 10000000),
    SENSOR(max_age_us, 250, LONGEST_us),
    SENSOR(stuck_us, 0, LONGEST_us),
    SENSOR(min_noise_counts, 0, 65535),
    SENSOR(max_lost_pct, 0, 100),
    SENSOR(latency_us, 0, 1000000),
    SENSOR(corner_mHz, 0, 20000),
};

static const range_t damper_ranges[] = {
    DAMPER(end_a, 0, QUIESCE_MAX_BODIES - 1),
    DAMPER(end_b, 0, QUIESCE_GROUND),
    DAMPER(ceiling_mA, 1, QUIESCE_HIGHEST_CURRENT_mA),
    DAMPER(safe_mA, 0, QUIESCE_HIGHEST_CURRENT_mA),
    DAMPER(continuous_mA, 1, QUIESCE_HIGHEST_CURRENT_mA),
    DAMPER(trip_mA, 0, 2 * QUIESCE_HIGHEST_CURRENT_mA),
    DAMPER(trip_us, 0, 10000000),
    DAMPER(heat_s, 5, 10000),
    DAMPER(measures_current, 0, 1),
    DAMPER(coil_lag_us, 0, 1000000),
    DAMPER(coil_mohm, 0, 1000000),
};

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

typedef struct {
    const char *part;
    int32_t number;
    quiesce_board_error_t *error;
} place_t;

static bool refuse(place_t at, const char *name, const char *reason) {
    if (at.error != NULL) {
        *at.error = (quiesce_board_error_t){at.part, at.number, name, reason, 0, 0};
    }
    return false;
}

static bool refuse_range(place_t at, const range_t *range) {
    if (at.error != NULL) {
        *at.error = (quiesce_board_error_t){at.part,        at.number,  range->name,
                                            "out of range", range->min, range->max};
    }
    return false;
}

// Fields of a part, in the order of its table.
static bool are_in_range(place_t at, const void *part, const range_t *ranges, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const int32_t value =
            *(const int32_t *)(const void *)((const uint8_t *)part + ranges[i].offset);
        if (value < ranges[i].min || value > ranges[i].max) {
            return refuse_range(at, &ranges[i]);
        }
    }
    return true;
}

static bool is_place_there(const quiesce_board_t *board, const quiesce_board_sensor_t *sensor) {
    if (sensor->sense == QUIESCE_SENSE_SUPPLY) {
        return sensor->at == 0;
    }
    return sensor->at < (quiesce_sense_is_of_body(sensor->sense) ? board->bodies : board->dampers);
}

static bool check_sensor(place_t at, const quiesce_board_t *board,
                         const quiesce_board_sensor_t *sensor) {
    if (!are_in_range(at, sensor, sensor_ranges, COUNT(sensor_ranges))) {
        return false;
    }
    if (sensor->polarity == 0) {
        return refuse(at, "polarity", "must be -1 or 1");
    }
    if (!is_place_there(board, sensor)) {
        return refuse(at, "at", "names a body or damper that the board does not have");
    }
    const int64_t reach = (int64_t)sensor->full_scale_counts * sensor->scale / SCALES_PER_UNIT;
    if (reach > (sensor->sense == QUIESCE_SENSE_ACCEL ? HIGHEST_ACCEL_um_s2 : HIGHEST_VALUE)) {
        return refuse(at, "scale",
                      sensor->sense == QUIESCE_SENSE_ACCEL
                          ? "full scale is beyond 500 m/s2, where accelerations saturate"
                          : "full scale is beyond 2^30 units");
    }
    if (sensor->corner_mHz != 0 && sensor->sense != QUIESCE_SENSE_ACCEL) {
        return refuse(at, "corner_mHz", "is made up for where accelerations are measured only");
    }
    if (sensor->min_noise_counts != 0 && sensor->period_us > SLOWEST_NOISE_us) {
        return refuse(at, "min_noise_counts", "needs ten samples a second, or 0");
    }
    if (sensor->stuck_us != 0 && sensor->stuck_us < 2 * (int64_t)sensor->period_us) {
        return refuse(at, "stuck_us", "below two periods: every sample would be a fault; or 0");
    }
    if (sensor->max_age_us < sensor->period_us) {
        return refuse(at, "max_age_us", "below period_us: it would be too old between two samples");
    }
    return true;
}

static bool is_same(const quiesce_board_sensor_t *a, const quiesce_board_sensor_t *b) {
    return a->sense == b->sense && a->at == b->at;
}

static bool has_voltage(const quiesce_board_t *board, int32_t damper) {
    for (int32_t i = 0; i < board->sensors; i++) {
        if (board->sensor[i].sense == QUIESCE_SENSE_VOLTAGE && board->sensor[i].at == damper) {
            return true;
        }
    }
    return false;
}

static bool are_sensors_good(const quiesce_board_t *board, quiesce_board_error_t *error) {
    for (int32_t i = 0; i < board->sensors; i++) {
        const place_t at = {"sensor", i, error};
        if (!check_sensor(at, board, &board->sensor[i])) {
            return false;
        }
        for (int32_t k = 0; k < i; k++) {
            if (is_same(&board->sensor[i], &board->sensor[k])) {
                return refuse(at, "at", "an earlier sensor measures the same there");
            }
        }
    }
    return true;
}

static bool check_damper(place_t at, const quiesce_board_t *board,
                         const quiesce_board_damper_t *damper) {
    if (!are_in_range(at, damper, damper_ranges, COUNT(damper_ranges))) {
        return false;
    }
    if (damper->end_a >= board->bodies) {
        return refuse(at, "end_a", "names a body that the board does not have");
    }
    if (damper->end_b != QUIESCE_GROUND && damper->end_b >= board->bodies) {
        return refuse(at, "end_b", "names a body that the board does not have");
    }
    if (damper->end_a == damper->end_b) {
        return refuse(at, "end_b", "is the same body as end_a");
    }
    if (damper->safe_mA > damper->ceiling_mA) {
        return refuse(at, "safe_mA", "above ceiling_mA");
    }
    if (damper->continuous_mA > damper->ceiling_mA) {
        return refuse(at, "continuous_mA", "above ceiling_mA");
    }
    if (damper->continuous_mA < (damper->ceiling_mA + 9) / 10) {
        return refuse(at, "continuous_mA", "below a tenth of ceiling_mA");
    }
    if (damper->safe_mA > damper->continuous_mA) {
        return refuse(at, "safe_mA", "above continuous_mA: it may stay there for ever");
    }
    if (damper->trip_mA != 0 && damper->trip_mA <= damper->ceiling_mA) {
        return refuse(at, "trip_mA", "not above ceiling_mA: a command would trip it");
    }
    if (damper->trip_mA != 0 && damper->measures_current == 0) {
        return refuse(at, "trip_mA", "needs measures_current");
    }
    if (damper->coil_mohm != 0 && damper->measures_current == 0) {
        return refuse(at, "coil_mohm", "needs measures_current");
    }
    if (damper->coil_mohm != 0 && !has_voltage(board, at.number)) {
        return refuse(at, "coil_mohm", "needs a sensor of its coil voltage");
    }
    return true;
}

static bool are_dampers_good(const quiesce_board_t *board, quiesce_board_error_t *error) {
    for (int32_t i = 0; i < board->dampers; i++) {
        if (!check_damper((place_t){"damper", i, error}, board, &board->damper[i])) {
            return false;
        }
    }
    return true;
}

bool quiesce_board_check(const quiesce_board_t *board, quiesce_board_error_t *error) {
    const place_t at = {"board", 0, error};
    if (!are_in_range(at, board, board_ranges, COUNT(board_ranges)) ||
        !are_sensors_good(board, error) || !are_dampers_good(board, error)) {
        return false;
    }
    if (board->tracked >= board->sensors ||
        board->sensor[board->tracked].sense != QUIESCE_SENSE_ACCEL) {
        return refuse(at, "tracked", "names no accelerometer");
    }
    if (board->sensor[board->tracked].period_us != 0) {
        return refuse(at, "tracked", "names a sensor without a sample every tick");
    }
    return true;
}
