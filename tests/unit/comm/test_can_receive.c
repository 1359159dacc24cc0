// What the controller takes from the bus, and when it is too old.
#include "can_make.h"
#include "can_receive.h"
#include "unity.h"

#include <string.h>

#define STOP QUIESCE_CAN_EMERGENCY_STOP_CODE_STOP_CHOICE
#define RATE_HZ 1000u

static can_receive_t bus;
static can_node_inputs_t inputs;

void setUp(void) {
    can_receive_init(&bus, RATE_HZ);
}

void tearDown(void) {}

static void take(can_frame_t frame) {
    (void)can_receive_frame(&bus, &frame);
}

static void pass(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        can_receive_inputs(&bus, 1, &inputs);
    }
}

// The third frame of an operator, the driver or the sensor is the one that is given. Who enables
// has let go before: then it is the second of those that enable.
static void introduce_operator(bool enable, bool fault_reset, uint8_t alive) {
    for (uint32_t i = enable ? 12 : 14; i <= 15; i++) {
        take(make_operator(enable && i == 15, fault_reset, (uint8_t)((alive + i) % 16u)));
        pass(100);
    }
}

static void introduce_driver(uint8_t alive) {
    for (uint32_t i = 14; i <= 15; i++) {
        take(make_current(1, (uint8_t)((alive + i) % 16u)));
        pass(10);
    }
}

static void introduce_sensor(uint8_t alive) {
    for (uint32_t i = 14; i <= 15; i++) {
        take(make_accel(1, false, false, (uint8_t)((alive + i) % 16u)));
        pass(1);
    }
}

static void check_inputs(const can_node_inputs_t *expected) {
    TEST_ASSERT_EQUAL(expected->enable, inputs.enable);
    TEST_ASSERT_EQUAL(expected->fault_reset, inputs.fault_reset);
    TEST_ASSERT_EQUAL(expected->estop, inputs.estop);
    TEST_ASSERT_EQUAL(expected->sensor[0].is_fresh, inputs.sensor[0].is_fresh);
    TEST_ASSERT_EQUAL_INT32(expected->sensor[0].counts, inputs.sensor[0].counts);
    TEST_ASSERT_EQUAL(expected->driver[0].is_measured, inputs.driver[0].is_measured);
    TEST_ASSERT_EQUAL_INT32(expected->driver[0].current_mA, inputs.driver[0].current_mA);
}

static void test_nothing_is_there_at_first(void) {
    const can_node_inputs_t nothing = {0};
    pass(1);
    check_inputs(&nothing);
}

static void test_values_arrive_in_the_next_tick(void) {
    introduce_operator(true, false, 1);
    pass(80);
    introduce_driver(9);
    introduce_sensor(7);
    take(make_stop(STOP, 3));
    take(make_accel(-8388608, false, false, 7));
    take(make_current(-32768, 9));
    TEST_ASSERT_EQUAL_UINT32(5, bus.counters.accepted); // two of the operator, who lets go first
    pass(1);
    TEST_ASSERT_TRUE(inputs.estop && inputs.sensor[0].is_fresh && inputs.driver[0].is_measured);
    TEST_ASSERT_EQUAL_INT32(-8388608, inputs.sensor[0].counts);
    TEST_ASSERT_EQUAL_INT32(-32768, inputs.driver[0].current_mA);
    TEST_ASSERT_FALSE(inputs.enable);
}

static void test_nothing_counts_before_the_third_frame(void) {
    introduce_operator(true, false, 0);
    TEST_ASSERT_FALSE(inputs.enable);
    take(make_operator(true, false, 0));
    pass(1);
    TEST_ASSERT_TRUE(inputs.enable);
    introduce_driver(0);
    TEST_ASSERT_FALSE(inputs.driver[0].is_measured);
    take(make_current(7, 0));
    introduce_sensor(0);
    TEST_ASSERT_FALSE(inputs.sensor[0].is_fresh);
    TEST_ASSERT_EQUAL_INT32(7, inputs.driver[0].current_mA);
    take(make_accel(1, false, false, 0));
    pass(1);
    TEST_ASSERT_TRUE(inputs.sensor[0].is_fresh);
    TEST_ASSERT_EQUAL_UINT32(5, bus.counters.accepted); // two of the operator, who lets go first
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.rejected_alive);
}

// One frame is one measurement: until the next it is told as an old one.
static void test_a_measurement_is_new_for_a_tick(void) {
    introduce_driver(0);
    for (uint8_t frame = 0; frame < 3; frame++) {
        take(make_current(100 + frame, frame));
        for (uint32_t tick = 0; tick < 10; tick++) {
            pass(1);
            TEST_ASSERT_TRUE(inputs.driver[0].is_measured);
            TEST_ASSERT_EQUAL(tick > 0, inputs.driver[0].is_old);
            TEST_ASSERT_EQUAL_INT32(100 + frame, inputs.driver[0].current_mA);
        }
    }
    pass(50);
    TEST_ASSERT_FALSE(inputs.driver[0].is_measured || inputs.driver[0].is_old);
}

// From the moment that it was due.
static void test_each_is_gone_after_its_timeout(void) {
    static const uint32_t rates_Hz[] = {500, 1000, 2000, 4000};
    for (uint32_t r = 0; r < 4; r++) {
        const uint32_t per_s = rates_Hz[r];
        can_receive_init(&bus, per_s);
        for (uint8_t i = 0; i < 3; i++) { // all 100 ms, and the driver all 10 ms before the last
            take(make_operator(i > 0, false, i));
            pass(i == 0 ? per_s / 10u : i == 1 ? per_s * 8u / 100u : 0);
            if (i > 0) {
                take(make_current(5, (uint8_t)(2 * i)));
                pass(i == 1 ? per_s / 100u : 0);
                take(make_current(5, (uint8_t)(2 * i + 1)));
                pass(i == 1 ? per_s / 100u : 0);
            }
        }
        take(make_stop(STOP, 0));
        for (uint32_t i = 1; i <= per_s; i++) {
            pass(1);
            TEST_ASSERT_EQUAL(i <= 200u * per_s / 1000u, inputs.estop);
            TEST_ASSERT_EQUAL(i <= 300u * per_s / 1000u, inputs.enable);
            TEST_ASSERT_EQUAL(i <= 50u * per_s / 1000u, inputs.driver[0].is_measured);
        }
    }
}

static void test_lost_ticks_count(void) {
    introduce_operator(true, false, 0);
    take(make_operator(true, false, 0));
    can_receive_inputs(&bus, 300, &inputs);
    TEST_ASSERT_TRUE(inputs.enable);
    can_receive_inputs(&bus, 1, &inputs);
    TEST_ASSERT_FALSE(inputs.enable);
    introduce_operator(true, false, 0);
    take(make_operator(true, false, 0));
    can_receive_inputs(&bus, UINT32_MAX, &inputs);
    TEST_ASSERT_FALSE(inputs.enable);
    can_receive_inputs(&bus, UINT32_MAX, &inputs);
    TEST_ASSERT_FALSE(inputs.enable);
}

static void test_times_follow_another_rate(void) {
    introduce_operator(true, false, 0);
    can_receive_use_rate(&bus, 500);
    take(make_operator(true, false, 0));
    pass(150);
    TEST_ASSERT_TRUE(inputs.enable);
    pass(1);
    TEST_ASSERT_FALSE(inputs.enable);
}

// Rounded up to a tick.
static void test_a_stop_holds_for_its_timeout_at_any_rate(void) {
    static const uint32_t rates_Hz[] = {1, 4, 333, 999, 1001, 4000, 48000};
    for (uint32_t i = 0; i < sizeof rates_Hz / sizeof rates_Hz[0]; i++) {
        can_receive_init(&bus, rates_Hz[i]);
        TEST_ASSERT_EQUAL_UINT32((200u * rates_Hz[i] + 999u) / 1000u, bus.stop.timeout_ticks);
        TEST_ASSERT_EQUAL_INT32(1000000 / (int32_t)rates_Hz[i], bus.tick_us);
    }
}

// Four periods; a fast sensor's is its message's; no cycle is shorter than a tick.
static void test_slow_sensor_has_its_period_and_four_of_them(void) {
    static const struct {
        uint32_t period_us, rate_Hz;
        int32_t cycle_us, timeout_us;
    } rows[] = {
        {0, 1000, 1000, 10000},
        {0, 4000, 1000, 10000},
        {0, 100, 10000, 10000},
        {2500, 1000, 2500, 10000},
        {2501, 1000, 2501, 10004},
        {30000, 500, 30000, 120000},
        {12345, 4000, 12345, 49380},
        {1000, 500, 2000, 10000},
        {10000000, 4000, 10000000, 40000000},
    };
    for (uint32_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        can_receive_init(&bus, 1000);
        bus.sensor[0].period_us = rows[i].period_us;
        can_receive_use_rate(&bus, rows[i].rate_Hz);
        TEST_ASSERT_EQUAL_INT32(rows[i].cycle_us, bus.sensor[0].from.cycle_us);
        TEST_ASSERT_EQUAL_INT32(rows[i].timeout_us, bus.sensor[0].from.timeout_us);
    }
}

// A tick that comes late: what arrived before it is as old as that.
static void test_sample_older_than_its_timeout_is_not_fresh(void) {
    introduce_sensor(0);
    take(make_accel(1, false, false, 0));
    can_receive_inputs(&bus, 100, &inputs);
    TEST_ASSERT_FALSE(inputs.sensor[0].is_fresh);
    TEST_ASSERT_EQUAL_INT32(0, inputs.sensor[0].counts);
}

// Whichever byte tells them apart: two frames of one counter are two senders.
static void check_two_senders(can_frame_t good, uint32_t byte, uint32_t message) {
    good.data[byte] ^= 0x80u;
    uint8_t alive = e2e_alive(&quiesce_can_messages[message].e2e, &good);
    e2e_protect(&quiesce_can_messages[message].e2e, &alive, &good);
    take(good);
}

static void test_any_byte_tells_two_senders_apart(void) {
    for (uint32_t byte = 0; byte < 2; byte++) {
        setUp();
        introduce_driver(0);
        take(make_current(5, 0));
        check_two_senders(make_current(5, 0), byte, QUIESCE_CAN_AT_CURRENT_MEASURED);
        pass(1);
        TEST_ASSERT_FALSE(inputs.driver[0].is_measured);
    }
    for (uint32_t byte = 0; byte < 3; byte++) {
        setUp();
        introduce_sensor(0);
        take(make_accel(5, false, false, 0));
        check_two_senders(make_accel(5, false, false, 0), byte, QUIESCE_CAN_AT_ACCEL_SAMPLE);
        TEST_ASSERT_FALSE(freshness_is_known(&bus.sensor[0].from));
    }
}

static uint32_t next_random(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static void check_tick(int32_t expected) {
    pass(1);
    TEST_ASSERT_TRUE(inputs.sensor[0].is_fresh);
    TEST_ASSERT_EQUAL_INT32(expected, inputs.sensor[0].counts);
}

static void check_tick_without(void) {
    pass(1);
    TEST_ASSERT_FALSE(inputs.sensor[0].is_fresh);
    TEST_ASSERT_EQUAL_INT32(0, inputs.sensor[0].counts);
}

static void test_a_sample_is_fresh_once_and_a_second_one_waits_for_the_next_tick(void) {
    introduce_sensor(0);
    take(make_accel(1, false, false, 0));
    take(make_accel(2, true, false, 1));
    check_tick(1);
    TEST_ASSERT_FALSE(inputs.sensor[0].is_saturated);
    check_tick(2);
    TEST_ASSERT_TRUE(inputs.sensor[0].is_saturated);
    check_tick_without();
}

static void test_of_three_samples_the_oldest_is_passed_over(void) {
    introduce_sensor(0);
    for (uint8_t i = 0; i < 3; i++) {
        take(make_accel(i, false, false, i));
    }
    check_tick(1);
    check_tick(2);
    check_tick_without();
}

static void test_after_lost_ticks_the_newest_sample_counts(void) {
    introduce_sensor(0);
    take(make_accel(1, false, false, 0));
    take(make_accel(2, false, false, 1));
    can_receive_inputs(&bus, 2, &inputs);
    TEST_ASSERT_EQUAL_INT32(2, inputs.sensor[0].counts);
    check_tick_without();
}

static void test_no_sample_of_a_slow_sensor_waits(void) {
    bus.sensor[0].period_us = 5000;
    can_receive_use_rate(&bus, RATE_HZ);
    for (uint8_t i = 0; i < 3; i++) {
        take(make_accel(i, false, false, i));
        pass(5);
    }
    pass(3); // one late and one early
    take(make_accel(3, false, false, 3));
    take(make_accel(4, false, false, 4));
    check_tick(4);
    check_tick_without();
}

static void test_what_waits_is_gone_with_its_sender(void) {
    introduce_sensor(0);
    take(make_accel(1, false, false, 0));
    take(make_accel(2, false, false, 1));
    check_tick(1);
    can_receive_inputs(&bus, 100, &inputs);
    TEST_ASSERT_FALSE(inputs.sensor[0].is_fresh);
    introduce_sensor(8);
    take(make_accel(3, false, false, 8));
    check_tick(3);
    check_tick_without();
}

// Who is a tick behind is so no longer than samples need it.
static void test_what_waits_is_passed_over_in_a_calm(void) {
    introduce_sensor(0);
    take(make_accel(0, false, false, 0));
    for (int32_t i = 1; i <= (int32_t)CAN_SENSOR_CALM_MS; i++) {
        take(make_accel(i, false, false, (uint8_t)(i % 16)));
        check_tick(i - 1);
    }
    const int32_t next = (int32_t)CAN_SENSOR_CALM_MS + 1;
    take(make_accel(next, false, false, (uint8_t)(next % 16)));
    check_tick(next);
    check_tick_without();
}

// A sensor whose clock is fast or slow, by ppm, and whose frames come up to 0.4 ticks early or
// late, over a minute: a slow one has a sample less each time that its clock has passed the
// controller's, and in no stretch of the calm is more than one missing.
static void check_clocks_that_pass(int32_t ppm) {
    uint32_t seed = 7;
    int64_t sent = 0;
    int32_t last = -1;
    int64_t jitter_ns = 0;
    uint32_t missing = 0;
    uint32_t missed_at = 0;
    can_receive_init(&bus, RATE_HZ);
    for (uint32_t t = 1; t <= 60000; t++) {
        while (sent * (1000000 - ppm) + jitter_ns < (int64_t)t * 1000000) {
            take(make_accel((int32_t)sent, false, false, (uint8_t)(sent % 16)));
            sent++;
            jitter_ns = (int64_t)(next_random(&seed) % 800000u) - 400000;
        }
        pass(1);
        if (inputs.sensor[0].is_fresh) {
            TEST_ASSERT_GREATER_THAN_INT32(last, inputs.sensor[0].counts);
            TEST_ASSERT_LESS_OR_EQUAL_INT32(2, (int32_t)sent - inputs.sensor[0].counts);
            last = inputs.sensor[0].counts;
        } else if (t > 10u) {
            TEST_ASSERT_TRUE(missing == 0 || t - missed_at > CAN_SENSOR_CALM_MS);
            missed_at = t;
            missing++;
        }
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(60u * (uint32_t)(ppm < 0 ? -ppm : 0) / 1000u + 2u, missing);
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.rejected_alive);
}

static void test_clocks_that_pass_each_other_cost_a_sample_at_most(void) {
    static const int32_t clocks_ppm[] = {-500, -100, -20, -1, 0, 1, 20, 100, 500};
    for (uint32_t i = 0; i < sizeof clocks_ppm / sizeof clocks_ppm[0]; i++) {
        check_clocks_that_pass(clocks_ppm[i]);
    }
}

static void test_bad_sample_is_none_and_a_saturated_one_is_one(void) {
    introduce_sensor(0);
    take(make_accel(5, false, true, 0));
    pass(1);
    TEST_ASSERT_FALSE(inputs.sensor[0].is_fresh);
    take(make_accel(8388607, true, false, 1));
    pass(1);
    TEST_ASSERT_TRUE(inputs.sensor[0].is_fresh);
    TEST_ASSERT_TRUE(inputs.sensor[0].is_saturated);
    TEST_ASSERT_EQUAL_INT32(8388607, inputs.sensor[0].counts);
    take(make_accel(7, false, false, 2));
    pass(1);
    TEST_ASSERT_FALSE(inputs.sensor[0].is_saturated);
    TEST_ASSERT_EQUAL_UINT32(3, bus.counters.accepted);
}

static void check_sample(uint8_t alive, bool expected) {
    take(make_accel(alive, false, false, alive));
    pass(1);
    TEST_ASSERT_EQUAL(expected, inputs.sensor[0].is_fresh);
}

static void test_repeated_and_jumped_counters_are_refused(void) {
    introduce_sensor(0);
    check_sample(0, true);
    check_sample(0, false); // repeated
    check_sample(2, true);  // one is missing
    check_sample(12, false);
    check_sample(4, true);
    pass(5);
    check_sample(10, true); // five are missing
    TEST_ASSERT_EQUAL_UINT32(2, bus.counters.rejected_alive);
}

// A sender that hangs sends the same frame for ever, as fast as it can, in its cycle, or just
// slower than it would be forgotten: it is present for its timeout, and never again.
static void test_hanging_sender_is_not_taken_for_a_new_one(void) {
    for (uint32_t pause = 1; pause <= 1000; pause = pause * 5u / 4u + 1u) {
        setUp();
        introduce_operator(true, false, 6);
        for (uint32_t i = 0; i < 3000; i++) {
            if (i % pause == 0) {
                take(make_operator(true, false, 6));
            }
            pass(1);
            TEST_ASSERT_EQUAL(i < 300, inputs.enable);
        }
    }
}

static void test_frozen_measurement_is_not_taken_for_a_new_one(void) {
    for (uint32_t pause = 1; pause <= 200; pause = pause * 5u / 4u + 1u) {
        setUp();
        introduce_driver(6);
        for (uint32_t i = 0; i < 3000; i++) {
            if (i % pause == 0) {
                take(make_current(77, 6));
            }
            pass(1);
            TEST_ASSERT_EQUAL(i < 50, inputs.driver[0].is_measured);
        }
    }
}

static void test_a_silent_sender_is_on_trial_again(void) {
    introduce_operator(true, false, 6);
    take(make_operator(true, false, 6));
    pass(301);
    TEST_ASSERT_FALSE(inputs.enable);
    introduce_operator(true, false, 6);
    TEST_ASSERT_FALSE(inputs.enable);
    take(make_operator(true, false, 6));
    pass(1);
    TEST_ASSERT_TRUE(inputs.enable);
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.rejected_alive);
}

// Whatever its counter, whenever it comes, whoever sends it.
static void test_an_operator_who_stops_is_believed_at_once(void) {
    for (uint8_t alive = 0; alive < 16; alive++) {
        for (uint32_t at = 0; at < 300; at += 7) {
            setUp();
            introduce_operator(true, false, 6);
            take(make_operator(true, false, 6));
            pass(at + 1);
            TEST_ASSERT_TRUE(inputs.enable);
            take(make_operator(false, false, alive));
            pass(1);
            TEST_ASSERT_FALSE(inputs.enable);
            take(make_operator(true, false, 7)); // one frame, even where that one did not fit
            pass(1);
            TEST_ASSERT_FALSE(inputs.enable);
        }
    }
}

// Nobody runs because of one frame: the operator's own has the same counter, or says no.
static void test_enable_takes_two_frames(void) {
    introduce_operator(false, false, 0);
    take(make_operator(false, false, 0));
    pass(90);
    take(make_operator(true, false, 1)); // inserted
    pass(10);
    TEST_ASSERT_FALSE(inputs.enable);
    take(make_operator(false, false, 1));
    pass(100);
    take(make_operator(true, false, 2));
    pass(1);
    TEST_ASSERT_FALSE(inputs.enable);

    setUp();
    introduce_operator(false, false, 0);
    take(make_operator(true, false, 0));
    pass(100);
    TEST_ASSERT_FALSE(inputs.enable);
    take(make_operator(true, false, 1));
    pass(1);
    TEST_ASSERT_TRUE(inputs.enable);
}

static void test_enable_that_is_held_is_none_until_it_is_let_go(void) {
    for (uint8_t i = 0; i < 40; i++) { // from the start on
        take(make_operator(true, false, i % 16u));
        pass(100);
        TEST_ASSERT_FALSE(inputs.enable);
    }
    take(make_operator(false, false, 8));
    pass(100);
    take(make_operator(true, false, 9));
    pass(100);
    take(make_operator(true, false, 10));
    pass(1);
    TEST_ASSERT_TRUE(inputs.enable);
    pass(400); // it falls silent, and comes back pressing
    for (uint8_t i = 0; i < 40; i++) {
        take(make_operator(true, false, i % 16u));
        pass(100);
        TEST_ASSERT_FALSE(inputs.enable);
    }
}

// A stop that somebody inserts stops; what the operator holds does not start it again.
static void test_enable_after_a_stop_that_does_not_count_has_to_be_let_go(void) {
    introduce_operator(true, false, 0);
    take(make_operator(true, false, 0));
    pass(50);
    TEST_ASSERT_TRUE(inputs.enable);
    take(make_operator(false, false, 7)); // out of its row
    pass(50);
    TEST_ASSERT_FALSE(inputs.enable);
    for (uint8_t i = 1; i < 30; i++) {
        take(make_operator(true, false, i % 16u));
        pass(100);
        TEST_ASSERT_FALSE(inputs.enable);
    }
}

static void test_stop_is_accepted_whatever_its_counter(void) {
    for (uint32_t i = 0; i < 100; i++) {
        take(make_stop(STOP, (uint8_t)(i % 3u == 0 ? 5 : 11)));
        pass(50);
        TEST_ASSERT_TRUE(inputs.estop);
    }
    pass(150);
    TEST_ASSERT_TRUE(inputs.estop);
    pass(1);
    TEST_ASSERT_FALSE(inputs.estop);
}

static void test_stop_counts_however_late_its_tick_is(void) {
    take(make_stop(STOP, 0));
    can_receive_inputs(&bus, 100000, &inputs);
    TEST_ASSERT_TRUE(inputs.estop);
    pass(1);
    TEST_ASSERT_FALSE(inputs.estop);
}

static void test_driver_that_reports_a_fault_has_failed(void) {
    // OK, OFF, OPEN_LOAD, SHORT, OVER_TEMPERATURE, SUPPLY, DEMAND_LOST, then what nobody knows.
    static const bool has_failed[16] = {false, false, true, true, true, true, false, true,
                                        true,  true,  true, true, true, true, true,  true};
    introduce_driver(0);
    for (uint8_t status = 0; status < 16u; status++) {
        take(make_driver(100, status, status));
        for (uint32_t i = 0; i < 10; i++) {
            pass(1);
            TEST_ASSERT_EQUAL(has_failed[status], inputs.driver[0].has_failed);
        }
    }
    pass(60);
    TEST_ASSERT_FALSE(inputs.driver[0].has_failed);
}

static void test_a_failure_is_believed_at_once_and_nothing_else(void) {
    take(make_driver(100, QUIESCE_CAN_CURRENT_MEASURED_DRIVER_STATUS_SHORT_CHOICE, 3));
    pass(1);
    TEST_ASSERT_TRUE(inputs.driver[0].has_failed);
    TEST_ASSERT_FALSE(inputs.driver[0].is_measured);
    pass(1);
    TEST_ASSERT_FALSE(inputs.driver[0].has_failed);
}

static void test_stop_with_another_code_is_none(void) {
    for (uint32_t code = 0; code <= UINT16_MAX; code++) {
        if (code != STOP) {
            take(make_stop((uint16_t)code, (uint8_t)(code % 16u)));
        }
    }
    pass(1);
    TEST_ASSERT_FALSE(inputs.estop);
    TEST_ASSERT_EQUAL_UINT32(65535, bus.counters.rejected_shape);
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.accepted);
}

// The operator's next frame, in its cycle.
static bool resets(bool fault_reset, uint8_t alive) {
    uint32_t ticks = 0;
    take(make_operator(false, fault_reset, alive));
    for (uint32_t i = 0; i < 100; i++) {
        pass(1);
        ticks += inputs.fault_reset ? 1u : 0u;
        TEST_ASSERT_TRUE(!inputs.fault_reset || i == 0);
    }
    return ticks == 1u;
}

typedef struct {
    bool is_pressed;
    bool resets;
} press_t;

static void test_fault_reset_acts_after_two_released_and_two_pressed_frames(void) {
    static const press_t row[] = {
        {true, false}, // was it pressed before? Not known
        {false, false}, {true, false},  {true, false},  {true, false}, // released only once
        {false, false}, {false, false}, {true, false},  {true, false},
        {true, true},                                                  // the frame after two
        {true, false},  {false, false}, {false, false}, {true, false}, // pressed only once
        {false, false}, {false, false}, {false, false}, {true, false},
        {true, false},  {false, true}, // released at once
        {false, false}, {true, false},  {true, false},
    };
    introduce_operator(false, true, 0);
    for (uint32_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        TEST_ASSERT_EQUAL(row[i].resets, resets(row[i].is_pressed, (uint8_t)(i % 16u)));
    }
    pass(201); // silence
    for (uint8_t i = 0; i < 20; i++) {
        TEST_ASSERT_FALSE(resets(true, i % 16u));
    }
}

// Whether it takes the place of the operator's frame or comes beside it.
static void test_one_frame_acknowledges_nothing(void) {
    introduce_operator(false, false, 0);
    TEST_ASSERT_FALSE(resets(false, 0));
    TEST_ASSERT_FALSE(resets(false, 1));
    TEST_ASSERT_FALSE(resets(true, 2)); // the operator's own is lost
    TEST_ASSERT_FALSE(resets(false, 3));
    TEST_ASSERT_FALSE(resets(false, 4));
    TEST_ASSERT_FALSE(resets(true, 5));  // the operator's own: too short
    take(make_operator(false, true, 6)); // inserted
    pass(5);
    take(make_operator(false, false, 6));
    pass(100);
    for (uint8_t alive = 7; alive < 12; alive++) {
        TEST_ASSERT_FALSE(resets(false, alive));
    }
}

static void test_a_burst_of_commands_is_none(void) {
    for (uint8_t i = 0; i < 200; i++) {
        take(make_operator(true, (i & 1u) != 0, i % 16u));
    }
    for (uint32_t i = 0; i < 500; i++) {
        pass(1);
        TEST_ASSERT_FALSE(inputs.enable || inputs.fault_reset);
    }
}

// Of sensors and dampers the first: how many there are is the build's (test_node_many.c).
static const uint32_t taken[] = {
    QUIESCE_CAN_AT_EMERGENCY_STOP,   QUIESCE_CAN_AT_ACCEL_SAMPLE,
    QUIESCE_CAN_AT_CURRENT_MEASURED, QUIESCE_CAN_AT_OPERATOR_COMMAND,
    QUIESCE_CAN_AT_SERVICE_REQUEST,
};

static can_frame_t make_any(uint32_t message, uint8_t alive) {
    switch (message) {
    case QUIESCE_CAN_AT_EMERGENCY_STOP:
        return make_stop(STOP, alive);
    case QUIESCE_CAN_AT_ACCEL_SAMPLE:
        return make_accel(77, false, false, alive);
    case QUIESCE_CAN_AT_CURRENT_MEASURED:
        return make_current(77, alive);
    case QUIESCE_CAN_AT_OPERATOR_COMMAND:
        return make_operator(true, true, alive);
    default:
        return make_request(QUIESCE_CAN_SERVICE_REQUEST_OPERATION_READ_CHOICE, 0, 0, alive);
    }
}

// Everything but the counters is as it was.
static void check_refused(can_frame_t frame) {
    const can_receive_t before = bus;
    TEST_ASSERT_FALSE(can_receive_frame(&bus, &frame));
    can_receive_t after = bus;
    after.counters = before.counters;
    TEST_ASSERT_EQUAL_MEMORY(&before, &after, sizeof after);
}

static void test_wrong_shapes_change_nothing(void) {
    uint32_t refused = 0;
    for (uint32_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        const can_frame_t good = make_any(taken[i], 3);
        for (uint32_t length = 0; length <= 255; length++) {
            for (uint32_t flags = 0; flags < 4; flags++) {
                can_frame_t frame = good;
                frame.length = (uint8_t)length;
                frame.is_extended = (flags & 1u) != 0;
                frame.is_remote = (flags & 2u) != 0;
                if (length != good.length || flags != 0) {
                    check_refused(frame);
                    refused++;
                }
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT32(refused, bus.counters.rejected_shape);
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.rejected_crc + bus.counters.rejected_alive);
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.accepted + bus.counters.unknown);
}

static void test_every_wrong_crc_changes_nothing(void) {
    for (uint32_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        can_frame_t frame = make_any(taken[i], 3);
        for (uint32_t error = 1; error <= 255; error++) {
            frame.data[frame.length - 1] ^= (uint8_t)error;
            check_refused(frame);
            frame.data[frame.length - 1] ^= (uint8_t)error;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(5 * 255, bus.counters.rejected_crc);
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.rejected_shape + bus.counters.rejected_alive);
    TEST_ASSERT_EQUAL_UINT32(0, bus.counters.accepted + bus.counters.unknown);
}

// What is damaged says nothing of its sender: it gets older as if nothing had come.
static void test_damaged_frames_leave_a_silent_sender_silent(void) {
    introduce_operator(true, false, 6);
    take(make_operator(true, false, 6));
    pass(100);
    can_frame_t short_one = make_operator(true, false, 7);
    can_frame_t damaged = make_operator(false, false, 7);
    short_one.length--;
    damaged.data[0] ^= 1u;
    check_refused(short_one);
    check_refused(damaged);
    pass(200);
    TEST_ASSERT_TRUE(inputs.enable);
    pass(1);
    TEST_ASSERT_FALSE(inputs.enable);
}

// A stop and a request count at once; a stranger's first frame is neither accepted nor refused.
static void test_each_good_frame_is_counted_once(void) {
    for (uint32_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
        const bool counts =
            taken[i] == QUIESCE_CAN_AT_EMERGENCY_STOP || taken[i] == QUIESCE_CAN_AT_SERVICE_REQUEST;
        const can_node_counters_t expected = {.accepted = counts ? 1u : 0u};
        can_receive_init(&bus, RATE_HZ);
        take(make_any(taken[i], 3));
        TEST_ASSERT_EQUAL_MEMORY(&expected, &bus.counters, sizeof expected);
    }
}

static void test_other_ids_are_none_of_our_business(void) {
    for (uint32_t id = 0; id <= CAN_MAX_STANDARD_ID; id++) {
        const can_frame_t frame = {.id = id, .length = 8};
        bool is_taken = id - QUIESCE_CAN_ACCEL_SAMPLE_FRAME_ID < QUIESCE_SENSORS ||
                        id - QUIESCE_CAN_CURRENT_MEASURED_FRAME_ID < QUIESCE_DAMPERS;
        for (uint32_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
            is_taken = is_taken || quiesce_can_messages[taken[i]].e2e.id == id;
        }
        if (!is_taken) {
            check_refused(frame);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(CAN_MAX_STANDARD_ID + 1u - 3u - QUIESCE_SENSORS - QUIESCE_DAMPERS,
                             bus.counters.unknown);
}

static can_frame_t make_hostile(uint32_t *seed) {
    can_frame_t frame = make_any(taken[next_random(seed) % 5u], (uint8_t)next_random(seed));
    frame.data[next_random(seed) % frame.length] ^= (uint8_t)(1u + next_random(seed) % 255u);
    return frame;
}

// 100,000 frames a tick, each a good one with one byte changed (a burst of up to 8 bits, which a
// CRC of 8 bits always finds), between good ones of a sensor.
static void test_flood_of_damaged_frames_disturbs_nothing(void) {
    static can_receive_t quiet;
    uint32_t seed = 3;
    introduce_operator(true, false, 0);
    take(make_operator(true, false, 0));
    introduce_sensor(0);
    quiet = bus;
    for (uint32_t tick = 0; tick < 10; tick++) {
        can_node_inputs_t expected;
        const can_frame_t good = make_accel((int32_t)tick, false, false, (uint8_t)tick);
        for (uint32_t i = 0; i < 100000; i++) {
            if (i == 50000) {
                take(good);
                (void)can_receive_frame(&quiet, &good);
            }
            take(make_hostile(&seed));
        }
        can_receive_inputs(&quiet, 1, &expected);
        pass(1);
        check_inputs(&expected);
        TEST_ASSERT_TRUE(inputs.sensor[0].is_fresh && inputs.enable && !inputs.estop);
    }
    TEST_ASSERT_EQUAL_UINT32(1000000, bus.counters.rejected_crc);
}

static void test_counters_saturate(void) {
    memset(&bus.counters, 0xFF, sizeof bus.counters);
    can_frame_t short_one = make_stop(STOP, 0);
    can_frame_t damaged = make_stop(STOP, 0);
    short_one.length = 2;
    damaged.data[0] ^= 1u;
    take(short_one);
    take(damaged);
    take(make_stop(STOP, 0));
    take(make_accel(0, false, false, 1));
    take(make_accel(0, false, false, 1));
    take((can_frame_t){.id = 1});
    TEST_ASSERT_EACH_EQUAL_HEX32(UINT32_MAX, &bus.counters, 5);
}

static void test_requests_are_handed_on_whatever_their_counter(void) {
    const can_frame_t frame = make_request(1, 0, 0, 5);
    TEST_ASSERT_TRUE(can_receive_frame(&bus, &frame));
    TEST_ASSERT_TRUE(can_receive_frame(&bus, &frame));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_nothing_is_there_at_first);
    RUN_TEST(test_values_arrive_in_the_next_tick);
    RUN_TEST(test_nothing_counts_before_the_third_frame);
    RUN_TEST(test_a_measurement_is_new_for_a_tick);
    RUN_TEST(test_each_is_gone_after_its_timeout);
    RUN_TEST(test_lost_ticks_count);
    RUN_TEST(test_times_follow_another_rate);
    RUN_TEST(test_a_stop_holds_for_its_timeout_at_any_rate);
    RUN_TEST(test_slow_sensor_has_its_period_and_four_of_them);
    RUN_TEST(test_sample_older_than_its_timeout_is_not_fresh);
    RUN_TEST(test_any_byte_tells_two_senders_apart);
    RUN_TEST(test_a_sample_is_fresh_once_and_a_second_one_waits_for_the_next_tick);
    RUN_TEST(test_of_three_samples_the_oldest_is_passed_over);
    RUN_TEST(test_after_lost_ticks_the_newest_sample_counts);
    RUN_TEST(test_no_sample_of_a_slow_sensor_waits);
    RUN_TEST(test_what_waits_is_gone_with_its_sender);
    RUN_TEST(test_what_waits_is_passed_over_in_a_calm);
    RUN_TEST(test_clocks_that_pass_each_other_cost_a_sample_at_most);
    RUN_TEST(test_bad_sample_is_none_and_a_saturated_one_is_one);
    RUN_TEST(test_repeated_and_jumped_counters_are_refused);
    RUN_TEST(test_hanging_sender_is_not_taken_for_a_new_one);
    RUN_TEST(test_frozen_measurement_is_not_taken_for_a_new_one);
    RUN_TEST(test_a_silent_sender_is_on_trial_again);
    RUN_TEST(test_an_operator_who_stops_is_believed_at_once);
    RUN_TEST(test_enable_takes_two_frames);
    RUN_TEST(test_enable_that_is_held_is_none_until_it_is_let_go);
    RUN_TEST(test_enable_after_a_stop_that_does_not_count_has_to_be_let_go);
    RUN_TEST(test_stop_is_accepted_whatever_its_counter);
    RUN_TEST(test_stop_counts_however_late_its_tick_is);
    RUN_TEST(test_driver_that_reports_a_fault_has_failed);
    RUN_TEST(test_a_failure_is_believed_at_once_and_nothing_else);
    RUN_TEST(test_stop_with_another_code_is_none);
    RUN_TEST(test_fault_reset_acts_after_two_released_and_two_pressed_frames);
    RUN_TEST(test_one_frame_acknowledges_nothing);
    RUN_TEST(test_a_burst_of_commands_is_none);
    RUN_TEST(test_wrong_shapes_change_nothing);
    RUN_TEST(test_every_wrong_crc_changes_nothing);
    RUN_TEST(test_damaged_frames_leave_a_silent_sender_silent);
    RUN_TEST(test_each_good_frame_is_counted_once);
    RUN_TEST(test_other_ids_are_none_of_our_business);
    RUN_TEST(test_flood_of_damaged_frames_disturbs_nothing);
    RUN_TEST(test_counters_saturate);
    RUN_TEST(test_requests_are_handed_on_whatever_their_counter);
    return UNITY_END();
}
