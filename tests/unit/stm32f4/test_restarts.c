// The record of faults over restarts: how many there may be, and what the watchdog adds.
#include "fault.h"
#include "unity.h"

#include <string.h>

void setUp(void) {
    memset(&cpu_fault, 0xA5, sizeof cpu_fault); // what memory has at a power-up
}

void tearDown(void) {}

static void test_a_power_up_has_no_record(void) {
    TEST_ASSERT_FALSE(fault_is_recorded());
    TEST_ASSERT_FALSE(fault_is_final());
    memset(&cpu_fault, 0, sizeof cpu_fault);
    TEST_ASSERT_FALSE(fault_is_recorded());
}

static void test_resets_by_the_watchdog_are_told_and_end_after_the_most_restarts(void) {
    for (uint32_t i = 1; i <= FAULT_MOST_RESTARTS; i++) {
        fault_count_watchdog();
        TEST_ASSERT_TRUE(fault_is_recorded());
        TEST_ASSERT_FALSE(fault_is_final());
        TEST_ASSERT_EQUAL_UINT32(i, cpu_fault.count);
        TEST_ASSERT_EQUAL_UINT32(0, cpu_fault.exception);
    }
    fault_count_watchdog();
    TEST_ASSERT_TRUE(fault_is_final());
}

static void test_both_kinds_count_together_until_they_are_acknowledged(void) {
    const cpu_fault_t hard = {.exception = 3, .pc = 0x08001234u, .cfsr = 0x100u};
    fault_count_watchdog();
    fault_count(&hard);
    TEST_ASSERT_EQUAL_UINT32(2, cpu_fault.count);
    TEST_ASSERT_EQUAL_HEX32(0x08001234u, cpu_fault.pc);
    fault_forget();
    TEST_ASSERT_FALSE(fault_is_recorded());
    fault_count(&hard);
    TEST_ASSERT_EQUAL_UINT32(1, cpu_fault.count);
    cpu_fault.pc ^= 1u; // damaged: nothing is believed
    TEST_ASSERT_FALSE(fault_is_recorded());
}

static void test_the_watchdog_that_ends_the_silence_leaves_the_final_fault(void) {
    const cpu_fault_t hard = {.exception = 3, .pc = 0x08001234u};
    for (uint32_t i = 0; i <= FAULT_MOST_RESTARTS; i++) {
        fault_count(&hard);
    }
    const cpu_fault_t before = cpu_fault;
    for (uint32_t i = 0; i < 3u; i++) {
        TEST_ASSERT_TRUE(fault_is_final());
        fault_count_watchdog();
        TEST_ASSERT_EQUAL_MEMORY(&before, &cpu_fault, sizeof before);
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_a_power_up_has_no_record);
    RUN_TEST(test_resets_by_the_watchdog_are_told_and_end_after_the_most_restarts);
    RUN_TEST(test_both_kinds_count_together_until_they_are_acknowledged);
    RUN_TEST(test_the_watchdog_that_ends_the_silence_leaves_the_final_fault);
    return UNITY_END();
}
