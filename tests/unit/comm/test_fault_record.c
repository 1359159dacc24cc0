// The record of a fault: what is in it, which fault's it is, when it goes, how it is read.
#include "fault_record.h"
#include "quiesce_can.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define BIN_TICKS 20u
#define AFTER_TICKS ((FAULT_RECORD_AFTER + 1u) * BIN_TICKS)
#define EMPTY 0x80007FFFu

static fault_record_t record;
static quiesce_out_t out;
static can_node_tick_t tick;
static uint32_t words[FAULT_RECORD_WORDS];

static const fault_record_about_t about = {1000, 0x11223344u, 0x55667788u, 3};

void setUp(void) {
    memset(&out, 0, sizeof out);
    tick = (can_node_tick_t){.ticks = 1};
    fault_record_init(&record, 1000);
}

void tearDown(void) {}

// zlib's, bit by bit.
static uint32_t crc_of(const uint8_t *bytes, uint32_t count) {
    uint32_t crc = UINT32_MAX;
    for (uint32_t i = 0; i < 8u * count; i++) {
        const uint32_t bit = (crc ^ (uint32_t)bytes[i / 8u] >> i % 8u) & 1u;
        crc = crc >> 1 ^ (bit != 0 ? 0xEDB88320u : 0u);
    }
    return ~crc;
}

static void step(void) {
    fault_record_watch(&record, &tick, &out);
    if (fault_record_wants_about(&record)) {
        fault_record_about(&record, &about);
    }
    out.telemetry.tick += tick.ticks;
}

static void run(uint32_t ticks) {
    for (uint32_t i = 0; i < ticks; i++) {
        step();
    }
}

static void enter(uint32_t fault) {
    out.telemetry.fault = fault;
    out.telemetry.fault_count++;
    step();
}

static void complete(void) {
    for (uint32_t i = 0; fault_record_is_busy(&record); i++) {
        TEST_ASSERT_LESS_THAN_UINT32(AFTER_TICKS + FAULT_RECORD_WORDS, i);
        step();
    }
    TEST_ASSERT_TRUE(fault_record_copy(&record, words));
    TEST_ASSERT_EQUAL_HEX32(crc_of((const uint8_t *)words, 4u * (FAULT_RECORD_WORDS - 1u)),
                            words[FAULT_RECORD_WORDS - 1u]);
}

static void press_reset(void) {
    tick.fault_reset = true;
    step();
    tick.fault_reset = false;
    step();
}

static uint32_t bin(uint32_t number, fault_record_signal_t signal) {
    return words[FAULT_RECORD_HEAD + number * FAULT_RECORD_SIGNALS + signal];
}

static uint32_t band(int32_t low, int32_t high) {
    return ((uint32_t)low & 0xFFFFu) | (uint32_t)high << 16;
}

static void test_a_record_says_what_ran_and_what_failed(void) {
    out.telemetry.state = QUIESCE_STATE_RUN;
    out.telemetry.bad_sample_count = 9;
    tick.accel_counts = -77;
    tick.overruns = 12;
    run(2000);
    out.telemetry.state = QUIESCE_STATE_FAULT;
    enter(QUIESCE_FAULT_OVERCURRENT);
    complete();
    TEST_ASSERT_EQUAL_HEX32(FAULT_RECORD_MAGIC, words[0]);
    TEST_ASSERT_EQUAL_MEMORY("QFR1", words, 4);
    TEST_ASSERT_EQUAL_HEX32(QUIESCE_FAULT_OVERCURRENT | (128u + QUIESCE_STATE_RUN) << 8 |
                                50u << 16 | 58u << 24,
                            words[1]);
    TEST_ASSERT_EQUAL_UINT32(2000, words[2]);
    TEST_ASSERT_EQUAL_HEX32(20u | 1000u << 16, words[3]);
    TEST_ASSERT_EQUAL_HEX32(about.param_hash, words[4]);
    TEST_ASSERT_EQUAL_HEX32(about.table_hash, words[5]);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_CAN_INTERFACE_VERSION, words[6] >> 24);
    TEST_ASSERT_EQUAL_UINT32(1, words[7]);
    TEST_ASSERT_EQUAL_INT32(-77, (int32_t)words[8]);
    TEST_ASSERT_EQUAL_UINT32(12, words[9]);
    TEST_ASSERT_EQUAL_UINT32(9, words[10]);
    TEST_ASSERT_EQUAL_HEX32(1u | 3u << 16, words[11]);
    TEST_ASSERT_EQUAL_HEX32(band(QUIESCE_STATE_RUN, QUIESCE_STATE_RUN),
                            bin(49, FAULT_RECORD_STATE));
    TEST_ASSERT_EQUAL_HEX32(band(QUIESCE_STATE_FAULT, QUIESCE_STATE_FAULT),
                            bin(50, FAULT_RECORD_STATE));
}

// Number i of the bins that were recorded has 20 i .. 20 i + 19 mA.
static void test_bins_are_the_last_second_in_order(void) {
    const uint32_t before = 7u * FAULT_RECORD_BINS * BIN_TICKS + 5u * BIN_TICKS + 3u;
    for (uint32_t i = 0; i < before + AFTER_TICKS; i++) {
        out.damper[0].current_cmd_mA = (int32_t)i;
        if (i == before) {
            enter(QUIESCE_FAULT_ESTOP);
        } else {
            step();
        }
    }
    complete();
    const uint32_t fault_bin = words[1] >> 16 & 0xFFu;
    TEST_ASSERT_EQUAL_UINT32(FAULT_RECORD_BEFORE, fault_bin);
    for (uint32_t i = 0; i < FAULT_RECORD_BINS; i++) {
        const int32_t low = (int32_t)((before / BIN_TICKS - fault_bin + i) * BIN_TICKS);
        TEST_ASSERT_EQUAL_HEX32(band(low, low + 19), bin(i, FAULT_RECORD_COMMAND));
    }
}

// In every tick of a bin.
static void test_the_bin_of_the_fault_is_in_its_place(void) {
    for (uint32_t at = 0; at < BIN_TICKS; at++) {
        setUp();
        run(100u * BIN_TICKS + at);
        out.damper[0].current_cmd_mA = 4321;
        enter(QUIESCE_FAULT_ESTOP);
        out.damper[0].current_cmd_mA = 0;
        complete();
        TEST_ASSERT_EQUAL_UINT32(50, words[1] >> 16 & 0xFFu);
        TEST_ASSERT_EQUAL_HEX32(band(0, 0), bin(49, FAULT_RECORD_COMMAND));
        TEST_ASSERT_EQUAL_UINT32(4321, bin(50, FAULT_RECORD_COMMAND) >> 16);
        TEST_ASSERT_EQUAL_HEX32(band(0, 0), bin(51, FAULT_RECORD_COMMAND));
    }
}

static void test_a_fault_in_the_first_tick_has_empty_bins_before(void) {
    enter(QUIESCE_FAULT_PARAMETER);
    complete();
    for (uint32_t i = 0; i < 50; i++) {
        TEST_ASSERT_EQUAL_HEX32(EMPTY, bin(i, FAULT_RECORD_ACCEL));
    }
    TEST_ASSERT_EQUAL_HEX32(0, bin(50, FAULT_RECORD_ACCEL));
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_STATE_INIT, words[1] >> 8 & 0xFFu);
}

static void test_signals_are_scaled_rounded_and_saturated(void) {
    tick.current_is_measured = true;
    for (uint32_t i = 0; i < 2; i++) {
        out.telemetry.accel_um_s2 = i == 0 ? -3000 : 2999; // -1.5 and 1.4995 of 2 mm/s2
        out.telemetry.displacement_nm = i == 0 ? INT32_MIN : INT32_MAX;
        out.telemetry.rms_um_s2 = i == 0 ? 499 : 32767500;
        out.telemetry.freq_uHz = 12345678;
        out.telemetry.freq_is_valid = 1;
        out.telemetry.current_law_mA = i == 0 ? -40000 : 40000;
        tick.current_meas_mA = i == 0 ? -5 : 7;
        out.damper[0].driver_enable = i == 0;
        out.telemetry.state = i == 0 ? QUIESCE_STATE_RUN : QUIESCE_STATE_SAFE;
        step();
    }
    run(BIN_TICKS - 2u);
    enter(QUIESCE_FAULT_SENSOR_LOST);
    complete();
    TEST_ASSERT_EQUAL_HEX32(band(-2, 1), bin(49, FAULT_RECORD_ACCEL));
    TEST_ASSERT_EQUAL_HEX32(band(-32768, 32767), bin(49, FAULT_RECORD_DISPLACEMENT));
    TEST_ASSERT_EQUAL_HEX32(band(0, 32767), bin(49, FAULT_RECORD_RMS));
    TEST_ASSERT_EQUAL_HEX32(band(1235, 1235), bin(49, FAULT_RECORD_FREQ));
    TEST_ASSERT_EQUAL_HEX32(band(-32768, 32767), bin(49, FAULT_RECORD_REQUEST));
    TEST_ASSERT_EQUAL_HEX32(band(-5, 7), bin(49, FAULT_RECORD_MEASURED));
    TEST_ASSERT_EQUAL_HEX32(band(3, 18), bin(49, FAULT_RECORD_STATE));
}

static void test_what_is_not_known_is_empty(void) {
    out.telemetry.freq_uHz = 5;
    tick.current_meas_mA = 5;
    run(BIN_TICKS);
    enter(QUIESCE_FAULT_SENSOR_LOST);
    complete();
    TEST_ASSERT_EQUAL_HEX32(EMPTY, bin(49, FAULT_RECORD_FREQ));
    TEST_ASSERT_EQUAL_HEX32(EMPTY, bin(49, FAULT_RECORD_MEASURED));
    TEST_ASSERT_EQUAL_HEX32(0, bin(49, FAULT_RECORD_COMMAND));
}

static void test_the_first_fault_stays_and_others_are_counted(void) {
    uint32_t first[FAULT_RECORD_WORDS];
    run(100);
    enter(QUIESCE_FAULT_COIL_OPEN);
    enter(QUIESCE_FAULT_ESTOP); // while it is taken
    complete();
    memcpy(first, words, sizeof first);
    for (uint32_t i = 0; i < 70000; i++) {
        enter(QUIESCE_FAULT_ESTOP);
    }
    complete();
    TEST_ASSERT_EQUAL_MEMORY(first, words, sizeof first);
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_COIL_OPEN, words[1] & 0xFFu);
    TEST_ASSERT_EQUAL_UINT32(65535, record.later);
}

static void test_an_acknowledged_one_can_be_read_until_the_next(void) {
    enter(QUIESCE_FAULT_COIL_OPEN);
    complete();
    press_reset(); // the fault holds: no acknowledgement
    TEST_ASSERT_FALSE(record.is_acknowledged);
    out.telemetry.fault = QUIESCE_FAULT_NONE;
    step();
    TEST_ASSERT_TRUE(record.is_acknowledged);
    complete();
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_COIL_OPEN, words[1] & 0xFFu);
    run(3000);
    out.damper[0].current_cmd_mA = 99;
    enter(QUIESCE_FAULT_ESTOP);
    complete();
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_ESTOP, words[1] & 0xFFu);
    TEST_ASSERT_EQUAL_UINT32(2, words[11] & 0xFFFFu);
    TEST_ASSERT_EQUAL_HEX32(band(0, 0), bin(49, FAULT_RECORD_COMMAND));
    TEST_ASSERT_FALSE(record.is_acknowledged);
}

// In every tick of the record of a lost tick, being taken, summed or held.
static void test_a_latched_fault_takes_the_place_of_one_that_heals(void) {
    for (uint32_t at = 1; at < AFTER_TICKS + FAULT_RECORD_WORDS + 10u; at++) {
        setUp();
        run(100);
        out.telemetry.state = QUIESCE_STATE_SAFE;
        enter(QUIESCE_FAULT_TICK_LOST);
        out.telemetry.fault = QUIESCE_FAULT_NONE;
        run(at);
        out.telemetry.state = QUIESCE_STATE_FAULT;
        enter(QUIESCE_FAULT_COIL_OPEN);
        run(30);
        enter(QUIESCE_FAULT_ESTOP); // the first of the latched ones stays
        complete();
        TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_COIL_OPEN, words[1] & 0xFFu);
        TEST_ASSERT_EQUAL_UINT32(50, words[1] >> 16 & 0xFFu);
        TEST_ASSERT_EQUAL_UINT32(2, words[11] & 0xFFFFu);
        TEST_ASSERT_EQUAL_UINT32(1, record.later);
        TEST_ASSERT_EQUAL_HEX32(band(QUIESCE_STATE_FAULT, QUIESCE_STATE_FAULT),
                                bin(51, FAULT_RECORD_STATE));
    }
}

static void test_a_fault_that_healed_waits_for_the_operator(void) {
    enter(QUIESCE_FAULT_SENSOR_LOST);
    complete();
    out.telemetry.fault = QUIESCE_FAULT_NONE;
    run(5000);
    TEST_ASSERT_FALSE(record.is_acknowledged);
    press_reset();
    TEST_ASSERT_TRUE(record.is_acknowledged);
}

static void test_a_button_that_is_held_from_the_start_acknowledges_nothing(void) {
    tick.fault_reset = true;
    enter(QUIESCE_FAULT_SENSOR_LOST);
    complete();
    out.telemetry.fault = QUIESCE_FAULT_NONE;
    run(100);
    TEST_ASSERT_FALSE(record.is_acknowledged);
}

static void test_clearing_forgets_it(void) {
    TEST_ASSERT_FALSE(fault_record_clear(&record));
    enter(QUIESCE_FAULT_SENSOR_LOST);
    TEST_ASSERT_FALSE(fault_record_clear(&record)); // not complete yet
    complete();
    TEST_ASSERT_TRUE(fault_record_clear(&record));
    TEST_ASSERT_FALSE(fault_record_copy(&record, words));
    TEST_ASSERT_FALSE(fault_record_request(&record, 0, 0));
    enter(QUIESCE_FAULT_ESTOP);
    complete();
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_ESTOP, words[1] & 0xFFu);
}

// What is kept over a restart changes with it.
static void test_generation_tells_of_every_change(void) {
    uint32_t seen = record.generation;
    enter(QUIESCE_FAULT_SENSOR_LOST);
    TEST_ASSERT_EQUAL_UINT32(seen, record.generation);
    complete();
    TEST_ASSERT_EQUAL_UINT32(++seen, record.generation);
    out.telemetry.fault = QUIESCE_FAULT_NONE;
    press_reset();
    TEST_ASSERT_EQUAL_UINT32(++seen, record.generation);
    press_reset();
    TEST_ASSERT_EQUAL_UINT32(seen, record.generation);
    (void)fault_record_clear(&record);
    TEST_ASSERT_EQUAL_UINT32(++seen, record.generation);
}

static void test_a_restart_ends_what_is_being_taken(void) {
    run(100u * BIN_TICKS);
    out.damper[0].current_cmd_mA = 77;
    enter(QUIESCE_FAULT_ESTOP);
    run(2u * BIN_TICKS);
    fault_record_restart(&record, 500);
    complete();
    const uint32_t fault_bin = words[1] >> 16 & 0xFFu;
    TEST_ASSERT_EQUAL_UINT32(55, fault_bin); // two of the seven after it
    TEST_ASSERT_EQUAL_HEX32(band(0, 0), bin(fault_bin - 1u, FAULT_RECORD_COMMAND));
    TEST_ASSERT_EQUAL_HEX32(band(77, 77), bin(fault_bin, FAULT_RECORD_COMMAND));
    TEST_ASSERT_EQUAL_UINT32(10, record.bin_ticks);
}

static void test_leaving_completes_it_at_once(void) {
    run(100);
    enter(QUIESCE_FAULT_ESTOP);
    fault_record_finish(&record);
    TEST_ASSERT_FALSE(fault_record_is_busy(&record));
    complete();
}

static void test_lost_ticks_take_their_bins(void) {
    run(100u * BIN_TICKS);
    tick.ticks = 10u * BIN_TICKS;
    out.damper[0].current_cmd_mA = 5;
    step();
    tick.ticks = 1;
    out.damper[0].current_cmd_mA = 0;
    run(5u * BIN_TICKS);
    enter(QUIESCE_FAULT_ESTOP);
    complete();
    uint32_t found = 0;
    for (uint32_t i = 0; i < 50; i++) {
        if (bin(i, FAULT_RECORD_COMMAND) == band(0, 5) ||
            bin(i, FAULT_RECORD_COMMAND) == band(5, 5)) {
            found = i;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(50 - 15, found);
    tick.ticks = UINT32_MAX; // bounded
    run(3);
}

/* Pages. */

static uint32_t read_pages(uint32_t first, uint32_t count) {
    can_frame_t frame;
    uint32_t seen = 0;
    TEST_ASSERT_TRUE(fault_record_request(&record, first, count));
    while (fault_record_page(&record, &frame)) {
        struct quiesce_can_fault_record_t page;
        (void)quiesce_can_fault_record_unpack(&page, frame.data, 8);
        TEST_ASSERT_EQUAL_UINT16(first + seen, page.record_page);
        TEST_ASSERT_EQUAL_UINT8(words[11] & 15u, page.record_number);
        TEST_ASSERT_EQUAL_MEMORY((const uint8_t *)words + 6u * page.record_page, &frame.data[2], 6);
        seen++;
    }
    return seen;
}

static void test_pages_are_the_record(void) {
    for (uint32_t i = 0; i < 2000; i++) {
        out.telemetry.accel_um_s2 = (int32_t)(i * 2654435761u) >> 8;
        out.telemetry.displacement_nm = (int32_t)(i * 40503u);
        step();
    }
    TEST_ASSERT_FALSE(fault_record_request(&record, 0, 0));
    enter(QUIESCE_FAULT_ESTOP);
    TEST_ASSERT_FALSE(fault_record_request(&record, 0, 0));
    complete();
    TEST_ASSERT_EQUAL_UINT32(318, FAULT_RECORD_PAGES);
    TEST_ASSERT_EQUAL_UINT32(FAULT_RECORD_PAGES, read_pages(0, 0));
    TEST_ASSERT_EQUAL_UINT32(3, read_pages(100, 3));
    TEST_ASSERT_EQUAL_UINT32(1, read_pages(FAULT_RECORD_PAGES - 1u, UINT32_MAX));
    TEST_ASSERT_FALSE(fault_record_request(&record, FAULT_RECORD_PAGES, 1));
}

static void test_pages_end_where_another_record_takes_the_place(void) {
    can_frame_t frame;
    enter(QUIESCE_FAULT_ESTOP);
    complete();
    out.telemetry.fault = QUIESCE_FAULT_NONE;
    press_reset();
    TEST_ASSERT_TRUE(fault_record_request(&record, 0, 0));
    enter(QUIESCE_FAULT_COIL_OPEN);
    TEST_ASSERT_TRUE(fault_record_page(&record, &frame));
    run(AFTER_TICKS);
    TEST_ASSERT_FALSE(fault_record_page(&record, &frame));
}

/* Kept over a restart. */

static void test_a_kept_record_is_read_again_and_stays_the_first(void) {
    uint32_t kept[FAULT_RECORD_WORDS];
    run(1234);
    enter(QUIESCE_FAULT_COIL_HOT);
    complete();
    memcpy(kept, words, sizeof kept);
    setUp();
    TEST_ASSERT_TRUE(fault_record_load(&record, kept, false));
    enter(QUIESCE_FAULT_ESTOP);
    complete();
    TEST_ASSERT_EQUAL_MEMORY(kept, words, sizeof kept);
    TEST_ASSERT_EQUAL_UINT32(FAULT_RECORD_PAGES, read_pages(0, 0));
    setUp();
    TEST_ASSERT_TRUE(fault_record_load(&record, kept, true));
    enter(QUIESCE_FAULT_ESTOP);
    complete();
    TEST_ASSERT_EQUAL_UINT32(QUIESCE_FAULT_ESTOP, words[1] & 0xFFu);
    TEST_ASSERT_EQUAL_UINT32(2, words[11] & 0xFFFFu);
}

// Any single bit.
static void test_a_damaged_record_is_refused(void) {
    enter(QUIESCE_FAULT_COIL_HOT);
    complete();
    fault_record_init(&record, 1000);
    for (uint32_t i = 0; i < 32u * FAULT_RECORD_WORDS; i++) {
        words[i / 32u] ^= 1u << i % 32u;
        TEST_ASSERT_FALSE(fault_record_load(&record, words, false));
        words[i / 32u] ^= 1u << i % 32u;
    }
    TEST_ASSERT_FALSE(record.is_held);
    memset(words, 0, sizeof words);
    TEST_ASSERT_FALSE(fault_record_load(&record, words, false));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_record_says_what_ran_and_what_failed);
    RUN_TEST(test_bins_are_the_last_second_in_order);
    RUN_TEST(test_the_bin_of_the_fault_is_in_its_place);
    RUN_TEST(test_a_fault_in_the_first_tick_has_empty_bins_before);
    RUN_TEST(test_signals_are_scaled_rounded_and_saturated);
    RUN_TEST(test_what_is_not_known_is_empty);
    RUN_TEST(test_the_first_fault_stays_and_others_are_counted);
    RUN_TEST(test_an_acknowledged_one_can_be_read_until_the_next);
    RUN_TEST(test_a_latched_fault_takes_the_place_of_one_that_heals);
    RUN_TEST(test_a_fault_that_healed_waits_for_the_operator);
    RUN_TEST(test_a_button_that_is_held_from_the_start_acknowledges_nothing);
    RUN_TEST(test_clearing_forgets_it);
    RUN_TEST(test_generation_tells_of_every_change);
    RUN_TEST(test_a_restart_ends_what_is_being_taken);
    RUN_TEST(test_leaving_completes_it_at_once);
    RUN_TEST(test_lost_ticks_take_their_bins);
    RUN_TEST(test_pages_are_the_record);
    RUN_TEST(test_pages_end_where_another_record_takes_the_place);
    RUN_TEST(test_a_kept_record_is_read_again_and_stays_the_first);
    RUN_TEST(test_a_damaged_record_is_refused);
    return UNITY_END();
}
