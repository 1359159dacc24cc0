// The freeze frame: when it is taken, what is in it, when it is sent.
#include "can_freeze.h"
#include "quiesce_can.h"
#include "unity.h"

#include <string.h>

static can_freeze_t freeze;
static quiesce_out_t out;
static can_freeze_tick_t tick;

void setUp(void) {
    memset(&out, 0, sizeof out);
    tick = (can_freeze_tick_t){.out = &out};
    can_freeze_init(&freeze, 250);
}

void tearDown(void) {}

static void watch(uint32_t fault, uint32_t fault_count) {
    out.telemetry.fault = fault;
    out.telemetry.fault_count = fault_count;
    out.telemetry.tick++;
    can_freeze_watch(&freeze, 1, &tick);
}

// All pages that wait, as one; returns their number.
static uint32_t read_pages(struct quiesce_can_fault_freeze_t pages[CAN_FREEZE_PAGES]) {
    can_frame_t frame;
    uint32_t count = 0;
    while (can_freeze_page(&freeze, &frame)) {
        TEST_ASSERT_LESS_THAN_UINT32(CAN_FREEZE_PAGES, count);
        (void)quiesce_can_fault_freeze_unpack(&pages[count], frame.data, sizeof frame.data);
        TEST_ASSERT_EQUAL_UINT8(count, pages[count].page);
        count++;
    }
    return count;
}

static uint32_t drop_pages(void) {
    struct quiesce_can_fault_freeze_t pages[CAN_FREEZE_PAGES];
    return read_pages(pages);
}

static void fill_healthy_tick(void) {
    out = (quiesce_out_t){.damper = {{.current_cmd_mA = 2100, .driver_enable = true}}};
    out.telemetry.state = QUIESCE_STATE_RUN;
    out.telemetry.tick = 70000;
    out.telemetry.current_law_mA = 2500;
    watch(QUIESCE_FAULT_NONE, 4);
}

static void fill_faulty_tick(void) {
    out.damper[0].current_cmd_mA = 250;
    out.telemetry.state = QUIESCE_STATE_SAFE;
    out.telemetry.current_law_mA = 1;
    out.telemetry.accel_um_s2 = -1234567;
    out.telemetry.freq_is_valid = 1;
    out.telemetry.rms_um_s2 = 999999999;
    out.telemetry.freq_uHz = 12345678;
    out.telemetry.displacement_amp_nm = -2000000000;
    tick.accel_counts = -8388608;
    tick.current_meas_mA = 40000; // beyond the signal
    tick.current_is_measured = true;
    watch(QUIESCE_FAULT_SENSOR_LOST, 5);
}

static void test_pages_have_the_tick_before_and_the_tick_of_the_fault(void) {
    struct quiesce_can_fault_freeze_t p[CAN_FREEZE_PAGES];
    fill_healthy_tick();
    TEST_ASSERT_EQUAL_UINT32(0, drop_pages());
    fill_faulty_tick();
    TEST_ASSERT_EQUAL_UINT32(CAN_FREEZE_PAGES, read_pages(p));
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_FAULT_SENSOR_LOST, p[0].freeze_fault);
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_STATE_RUN, p[0].freeze_state);
    TEST_ASSERT_EQUAL_UINT32(70002, p[0].freeze_tick);
    TEST_ASSERT_EQUAL_INT32(-8388608, p[1].freeze_accel_counts);
    TEST_ASSERT_EQUAL_INT32(-1234567, p[1].freeze_accel_um_s2);
    TEST_ASSERT_EQUAL_UINT8(1, p[2].freeze_freq_is_valid);
    TEST_ASSERT_EQUAL_INT32(999999999, p[2].freeze_rms_um_s2);
    TEST_ASSERT_EQUAL_INT32(12345678, p[3].freeze_freq_uHz);
    TEST_ASSERT_EQUAL_UINT8(1, p[4].freeze_current_is_measured);
    TEST_ASSERT_EQUAL_UINT16(2100, p[4].freeze_current_cmd_mA);
    TEST_ASSERT_EQUAL_INT16(32767, p[4].freeze_current_meas_mA);
    TEST_ASSERT_EQUAL_UINT16(2500, p[4].freeze_current_law_mA);
    TEST_ASSERT_EQUAL_INT32(-2000000000, p[5].freeze_displacement_amp_nm);
    for (uint32_t i = 0; i < CAN_FREEZE_PAGES; i++) {
        TEST_ASSERT_EQUAL_UINT8(1, p[i].freeze_number);
    }
}

static void test_negative_currents_are_0(void) {
    struct quiesce_can_fault_freeze_t p[CAN_FREEZE_PAGES];
    out.damper[0].current_cmd_mA = INT32_MIN;
    out.telemetry.current_law_mA = -1;
    watch(QUIESCE_FAULT_NONE, 0);
    tick.accel_counts = INT32_MIN;
    tick.current_meas_mA = INT32_MIN;
    watch(QUIESCE_FAULT_ESTOP, 1);
    TEST_ASSERT_EQUAL_UINT32(CAN_FREEZE_PAGES, read_pages(p));
    TEST_ASSERT_EQUAL_INT32(-8388608, p[1].freeze_accel_counts);
    TEST_ASSERT_EQUAL_UINT16(0, p[4].freeze_current_cmd_mA);
    TEST_ASSERT_EQUAL_UINT16(0, p[4].freeze_current_law_mA);
    TEST_ASSERT_EQUAL_INT16(0, p[4].freeze_current_meas_mA); // there is no measurement
}

static void test_a_fault_in_the_first_tick_has_the_safe_current_before(void) {
    struct quiesce_can_fault_freeze_t p[CAN_FREEZE_PAGES];
    watch(QUIESCE_FAULT_PARAMETER, 1);
    TEST_ASSERT_EQUAL_UINT32(CAN_FREEZE_PAGES, read_pages(p));
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_STATE_INIT, p[0].freeze_state);
    TEST_ASSERT_EQUAL_UINT16(250, p[4].freeze_current_cmd_mA);
}

static void test_it_comes_again_every_second_while_the_fault_holds(void) {
    uint32_t sent = 0;
    watch(QUIESCE_FAULT_ESTOP, 1);
    for (uint32_t i = 1; i <= 5000; i++) {
        sent += drop_pages();
        watch(QUIESCE_FAULT_ESTOP, 1);
    }
    TEST_ASSERT_EQUAL_UINT32(5u * CAN_FREEZE_PAGES, sent); // the sixth waits
    TEST_ASSERT_EQUAL_UINT32(CAN_FREEZE_PAGES, drop_pages());
    for (uint32_t i = 0; i < 5000; i++) {
        watch(QUIESCE_FAULT_NONE, 1);
        TEST_ASSERT_EQUAL_UINT32(0, drop_pages());
    }
}

static void test_every_fault_has_its_own_number_and_words(void) {
    struct quiesce_can_fault_freeze_t p[CAN_FREEZE_PAGES];
    for (uint32_t i = 1; i <= 40; i++) {
        const uint32_t fault = 1u + i % 11u;
        watch(fault, i); // one after the other, without a tick between
        TEST_ASSERT_EQUAL_UINT32(CAN_FREEZE_PAGES, read_pages(p));
        TEST_ASSERT_EQUAL_UINT8(fault, p[0].freeze_fault);
        TEST_ASSERT_EQUAL_UINT8(i % 16u, p[3].freeze_number);
    }
}

static void test_the_same_fault_entered_again_is_another_one(void) {
    watch(QUIESCE_FAULT_ESTOP, 1);
    (void)drop_pages();
    watch(QUIESCE_FAULT_ESTOP, 2);
    TEST_ASSERT_EQUAL_UINT32(CAN_FREEZE_PAGES, drop_pages());
    TEST_ASSERT_EQUAL_UINT8(2, freeze.number);
}

static void test_request_sends_the_last_one_also_after_a_restart(void) {
    struct quiesce_can_fault_freeze_t p[CAN_FREEZE_PAGES];
    TEST_ASSERT_FALSE(can_freeze_request(&freeze));
    TEST_ASSERT_EQUAL_UINT32(0, drop_pages());
    watch(QUIESCE_FAULT_ESTOP, 1);
    (void)drop_pages();
    can_freeze_restart(&freeze, 250);
    watch(QUIESCE_FAULT_NONE, 0);
    TEST_ASSERT_TRUE(can_freeze_request(&freeze));
    TEST_ASSERT_EQUAL_UINT32(CAN_FREEZE_PAGES, read_pages(p));
    TEST_ASSERT_EQUAL_UINT8(QUIESCE_FAULT_ESTOP, p[0].freeze_fault);
    watch(QUIESCE_FAULT_ESTOP, 1); // the same count as before the restart
    TEST_ASSERT_EQUAL_UINT8(2, freeze.number);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_pages_have_the_tick_before_and_the_tick_of_the_fault);
    RUN_TEST(test_negative_currents_are_0);
    RUN_TEST(test_a_fault_in_the_first_tick_has_the_safe_current_before);
    RUN_TEST(test_it_comes_again_every_second_while_the_fault_holds);
    RUN_TEST(test_every_fault_has_its_own_number_and_words);
    RUN_TEST(test_the_same_fault_entered_again_is_another_one);
    RUN_TEST(test_request_sends_the_last_one_also_after_a_restart);
    return UNITY_END();
}
