// What can be had without a watchdog: a real one (softdog) is fed in the virtual machine.
#include "one_line.h"
#include "unity.h"
#include "watchdog.h"

static linux_error_t error;

void setUp(void) {
    error.text[0] = '\0';
}

void tearDown(void) {}

static void test_missing_device_is_one_line(void) {
    TEST_ASSERT_NULL(watchdog_open("/dev/no-such-watchdog", 5, &error));
    assert_one_line(&error, "watchdog /dev/no-such-watchdog: No such file");
}

static void test_file_that_is_no_watchdog_is_refused(void) {
    TEST_ASSERT_NULL(watchdog_open("/dev/null", 5, &error));
    assert_one_line(&error, "this is no watchdog");
    TEST_ASSERT_NULL(watchdog_open("/", 5, &error));
    assert_one_line(&error, "Is a directory");
}

static void test_timeout_below_a_second_is_refused_and_nothing_is_opened(void) {
    TEST_ASSERT_NULL(watchdog_open("/dev/no-such-watchdog", 0, &error));
    assert_one_line(&error, "must be at least 1");
    TEST_ASSERT_NULL(watchdog_open("/dev/no-such-watchdog", -5, &error));
    assert_one_line(&error, "must be at least 1");
}

static void test_closing_nothing_is_allowed(void) {
    watchdog_close(NULL);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_missing_device_is_one_line);
    RUN_TEST(test_file_that_is_no_watchdog_is_refused);
    RUN_TEST(test_timeout_below_a_second_is_refused_and_nothing_is_opened);
    RUN_TEST(test_closing_nothing_is_allowed);
    return UNITY_END();
}
