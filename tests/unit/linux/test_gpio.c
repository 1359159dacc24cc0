// Runs once with each version of libgpiod. Lines themselves are exercised in the virtual machine:
// this machine has no chip.
#include "gpio.h"
#include "gpio_place.h"
#include "one_line.h"
#include "scratch.h"
#include "unity.h"

#include <errno.h>
#include <stdio.h>
#include <unistd.h>

static linux_error_t error;

void setUp(void) {
    error.text[0] = '\0';
    scratch_make();
}

void tearDown(void) {
    scratch_remove();
}

static void assert_refused(const char *line, const char *part) {
    const gpio_spec_t spec = {.line = line};
    TEST_ASSERT_NULL(gpio_open_output(&spec, false, &error));
    assert_one_line(&error, part);
    error.text[0] = '\0';
    TEST_ASSERT_NULL(gpio_open_input(&spec, &error));
    assert_one_line(&error, part);
}

static void test_malformed_specification_is_one_line(void) {
    static const char *const lines[] = {
        "gpiochip0",    "gpiochip0:",         "gpiochip0:x",     "gpiochip0:-1",
        "gpiochip0:3x", "gpiochip0: 3",       "gpiochip0:65536", "gpiochip0:99999999999999999999",
        "/dev/",        "/dev/gpiochip0:0x3",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        assert_refused(lines[i], "gpiochip0:3");
    }
    assert_refused("", "give its name");
    assert_refused(NULL, "give its name");
    assert_refused("/dev/a-very-long-name-of-a-chip-that-no-kernel-would-ever-give-to-a-chip:3",
                   "too long");
}

static void test_chip_that_is_not_there_is_one_line(void) {
    assert_refused("gpiochip4000:3", "no such GPIO chip");
    assert_refused("/dev/gpiochip4000:3", "no such GPIO chip");
}

static void test_file_that_is_no_chip_is_one_line(void) {
    char line[SCRATCH_BYTES];
    assert_refused("/dev/null:0", "GPIO line '/dev/null:0'");
    assert_refused("/dev/zero:0", "no such GPIO chip");
    assert_refused("/dev/shm:0", "GPIO line '/dev/shm:0'");
    scratch_write("file", "text");
    (void)snprintf(line, sizeof line, "/dev/..%s:0", scratch_path("file"));
    assert_refused(line, "no such GPIO chip");
}

static void test_name_that_no_chip_has_is_one_line(void) {
    assert_refused("no line of this name", "has a line of this name");
    assert_refused("ESTOP:3%s%n", "'ESTOP:3%s%n'");
}

static void test_reasons_of_the_kernel_become_hints(void) {
    static const struct {
        int number;
        const char *consumer;
        const char *text;
    } cases[] = {
        {EBUSY, "gpiomon", "in use by 'gpiomon'"},
        {EBUSY, NULL, "in use by 'unknown'"},
        {EACCES, NULL, "group gpio"},
        {ENXIO, NULL, "no edges"},
        {EINVAL, NULL, "no such line"},
        {ENODEV, NULL, "no such GPIO chip"},
        {EIO, NULL, "Input/output error"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_FALSE(gpio_refuse(&error, "ESTOP", cases[i].number, cases[i].consumer));
        assert_one_line(&error, cases[i].text);
        assert_one_line(&error, "ESTOP");
    }
}

static void test_closing_nothing_is_allowed(void) {
    gpio_close(NULL);
}

static void test_library_is_the_one_that_was_built_for(void) {
    TEST_ASSERT_EQUAL_STRING_LEN(GPIO_TEST_LIBRARY, gpio_library(), sizeof GPIO_TEST_LIBRARY - 1u);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_malformed_specification_is_one_line);
    RUN_TEST(test_chip_that_is_not_there_is_one_line);
    RUN_TEST(test_file_that_is_no_chip_is_one_line);
    RUN_TEST(test_name_that_no_chip_has_is_one_line);
    RUN_TEST(test_reasons_of_the_kernel_become_hints);
    RUN_TEST(test_closing_nothing_is_allowed);
    RUN_TEST(test_library_is_the_one_that_was_built_for);
    return UNITY_END();
}
