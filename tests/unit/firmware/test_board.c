// Boards that are accepted, and every way in which one is refused.
#include "quiesce_board.h"

#include <stddef.h>
#include <string.h>

#include "unity.h"

static quiesce_board_t board;

// Two bodies, two accelerometers, a stroke sensor, two dampers.
static void make_board(void) {
    quiesce_board_default(&board);
    board.sensors = 3;
    board.bodies = 2;
    board.dampers = 2;
    board.sensor[1] = board.sensor[0];
    board.sensor[1].at = 1;
    board.sensor[2] = board.sensor[0];
    board.sensor[2].sense = QUIESCE_SENSE_STROKE;
    board.sensor[2].full_scale_counts = 32767;
    board.damper[1] = board.damper[0];
    board.damper[1].end_a = 1;
    board.damper[1].end_b = 0;
}

void setUp(void) {
    make_board();
}
void tearDown(void) {}

static void assert_refused(const char *part, int32_t number, const char *name, const char *reason) {
    quiesce_board_error_t error = {0};
    TEST_ASSERT_FALSE_MESSAGE(quiesce_board_check(&board, &error), name);
    TEST_ASSERT_FALSE(quiesce_board_check(&board, NULL));
    TEST_ASSERT_EQUAL_STRING(part, error.part);
    TEST_ASSERT_EQUAL_STRING(name, error.name);
    TEST_ASSERT_EQUAL_INT32(number, error.number);
    TEST_ASSERT_NOT_NULL(strstr(error.reason, reason));
    make_board();
}

static void test_board_good_ones(void) {
    TEST_ASSERT_TRUE(quiesce_board_check(&board, NULL));
    quiesce_board_default(&board);
    TEST_ASSERT_TRUE(quiesce_board_check(&board, NULL));
}

#define FIELD(type, name, low, high)                                                               \
    { offsetof(type, name), #name, low, high }

typedef struct {
    size_t offset;
    const char *name;
    int32_t below, above; ///< the first values out of range
} field_t;

static void try_fields(const char *part, int32_t number, size_t base, const field_t *fields,
                       size_t count) {
    for (size_t i = 0; i < count; i++) {
        const int32_t values[] = {fields[i].below, fields[i].above, INT32_MIN, INT32_MAX};
        for (size_t k = 0; k < 4; k++) {
            int32_t *field = (int32_t *)(void *)((uint8_t *)&board + base + fields[i].offset);
            *field = values[k];
            assert_refused(part, number, fields[i].name, "out of range");
        }
    }
}

static void test_board_every_field_has_its_range(void) {
    const field_t of_board[] = {
        FIELD(quiesce_board_t, sensors, 0, QUIESCE_SENSORS + 1),
        FIELD(quiesce_board_t, bodies, 0, QUIESCE_BODIES + 1),
        FIELD(quiesce_board_t, dampers, 0, QUIESCE_DAMPERS + 1),
        FIELD(quiesce_board_t, tracked, -1, QUIESCE_SENSORS),
        FIELD(quiesce_board_t, bus_latency_us, -1, 100001),
    };
    try_fields("board", 0, 0, of_board, sizeof of_board / sizeof of_board[0]);
    const field_t of_sensor[] = {
        FIELD(quiesce_board_sensor_t, sense, -1, QUIESCE_SENSES),
        FIELD(quiesce_board_sensor_t, at, -1, 4),
        FIELD(quiesce_board_sensor_t, axis, -1, 3),
        FIELD(quiesce_board_sensor_t, polarity, -2, 2),
        FIELD(quiesce_board_sensor_t, scale, 0, 1000000001),
        FIELD(quiesce_board_sensor_t, offset_counts, -8388608, 8388608),
        FIELD(quiesce_board_sensor_t, full_scale_counts, 126, 8388608),
        FIELD(quiesce_board_sensor_t, period_us, -1, 10000001),
        FIELD(quiesce_board_sensor_t, max_age_us, 249, 100000001),
        FIELD(quiesce_board_sensor_t, stuck_us, -1, 100000001),
        FIELD(quiesce_board_sensor_t, min_noise_counts, -1, 65536),
        FIELD(quiesce_board_sensor_t, max_lost_pct, -1, 101),
        FIELD(quiesce_board_sensor_t, latency_us, -1, 1000001),
        FIELD(quiesce_board_sensor_t, corner_mHz, -1, 20001),
    };
    for (int32_t i = 0; i < 3; i++) {
        try_fields("sensor", i,
                   offsetof(quiesce_board_t, sensor) + (size_t)i * sizeof board.sensor[0],
                   of_sensor, sizeof of_sensor / sizeof of_sensor[0]);
    }
    const field_t of_damper[] = {
        FIELD(quiesce_board_damper_t, end_a, -1, 4),
        FIELD(quiesce_board_damper_t, end_b, -1, 256),
        FIELD(quiesce_board_damper_t, ceiling_mA, 0, 20001),
        FIELD(quiesce_board_damper_t, safe_mA, -1, 20001),
        FIELD(quiesce_board_damper_t, continuous_mA, 0, 20001),
        FIELD(quiesce_board_damper_t, trip_mA, -1, 40001),
        FIELD(quiesce_board_damper_t, trip_us, -1, 10000001),
        FIELD(quiesce_board_damper_t, measures_current, -1, 2),
        FIELD(quiesce_board_damper_t, coil_lag_us, -1, 1000001),
        FIELD(quiesce_board_damper_t, coil_mohm, -1, 1000001),
    };
    for (int32_t i = 0; i < 2; i++) {
        try_fields("damper", i,
                   offsetof(quiesce_board_t, damper) + (size_t)i * sizeof board.damper[0],
                   of_damper, sizeof of_damper / sizeof of_damper[0]);
    }
}

static void test_board_sensors_contradict(void) {
    board.sensor[2].corner_mHz = 500;
    assert_refused("sensor", 2, "corner_mHz", "accelerations");
    board.sensor[0].polarity = 0;
    assert_refused("sensor", 0, "polarity", "-1 or 1");
    board.sensor[1].at = 2;
    assert_refused("sensor", 1, "at", "does not have");
    board.sensor[2].at = 2;
    assert_refused("sensor", 2, "at", "does not have");
    board.sensor[2].sense = QUIESCE_SENSE_SUPPLY;
    board.sensor[2].at = 1;
    assert_refused("sensor", 2, "at", "does not have");
    board.sensor[1].at = 0;
    assert_refused("sensor", 1, "at", "an earlier sensor");
    board.sensor[2].period_us = 130000;
    board.sensor[2].max_age_us = 500000;
    board.sensor[2].stuck_us = 250000;
    assert_refused("sensor", 2, "stuck_us", "two periods");
    board.sensor[2].scale = 1000000000;
    assert_refused("sensor", 2, "scale", "2^30");
    board.sensor[2].period_us = 20000;
    assert_refused("sensor", 2, "max_age_us", "period_us");
    board.sensor[2].period_us = 200000;
    board.sensor[2].max_age_us = 400000;
    board.sensor[2].min_noise_counts = 5;
    assert_refused("sensor", 2, "min_noise_counts", "ten samples");
    board.tracked = 2;
    assert_refused("board", 0, "tracked", "no accelerometer");
    board.tracked = 3;
    assert_refused("board", 0, "tracked", "no accelerometer");
    board.sensor[1].period_us = 2000;
    board.tracked = 1;
    assert_refused("board", 0, "tracked", "every tick");
}

static void test_board_dampers_contradict(void) {
    board.damper[0].end_a = 2;
    assert_refused("damper", 0, "end_a", "does not have");
    board.damper[1].end_b = 3;
    assert_refused("damper", 1, "end_b", "does not have");
    board.damper[1].end_b = 1;
    assert_refused("damper", 1, "end_b", "the same body");
    board.damper[0].safe_mA = 5001;
    assert_refused("damper", 0, "safe_mA", "ceiling_mA");
    board.damper[0].continuous_mA = 5001;
    assert_refused("damper", 0, "continuous_mA", "ceiling_mA");
    board.damper[0].continuous_mA = 2000;
    board.damper[0].safe_mA = 2001;
    assert_refused("damper", 0, "safe_mA", "continuous_mA");
    board.damper[1].measures_current = 1;
    board.damper[1].trip_mA = 5000;
    assert_refused("damper", 1, "trip_mA", "not above");
    board.damper[1].trip_mA = 7000;
    assert_refused("damper", 1, "trip_mA", "measures_current");
    board.damper[1].coil_mohm = 2500;
    assert_refused("damper", 1, "coil_mohm", "measures_current");
    board.damper[1].measures_current = 1;
    board.damper[1].coil_mohm = 2500;
    assert_refused("damper", 1, "coil_mohm", "coil voltage");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_board_good_ones);
    RUN_TEST(test_board_every_field_has_its_range);
    RUN_TEST(test_board_sensors_contradict);
    RUN_TEST(test_board_dampers_contradict);
    return UNITY_END();
}
