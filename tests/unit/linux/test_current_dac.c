// Against the kernel's file interface in a folder. Untested on hardware.
#include "current_backends.h"
#include "one_line.h"
#include "scratch.h"
#include "unity.h"

#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#define DEVICE "sys/iio:device1"
#define NEVER_MS 3600000u

static char root[SCRATCH_BYTES];
static hal_current_t current;
static current_dac_t *driver;
static uint32_t refresh_ms;
static linux_error_t error;

void setUp(void) {
    error.text[0] = '\0';
    driver = NULL;
    refresh_ms = NEVER_MS;
    scratch_make();
    scratch_folder(DEVICE);
    scratch_write(DEVICE "/name", "ad5693r\n");
    scratch_write(DEVICE "/out_voltage0_raw", "9999\n");
    (void)snprintf(root, sizeof root, "%s", scratch_path("sys"));
}

void tearDown(void) {
    current_dac_close(driver);
    scratch_remove();
}

static current_dac_options_t options_of(int32_t zero_code, int32_t full_scale_code) {
    return (current_dac_options_t){
        .device = "ad5693r",
        .zero_code = zero_code,
        .full_scale_code = full_scale_code,
        .full_scale_mA = 3000,
        .refresh_ms = refresh_ms,
        .sysfs_root = root,
    };
}

static void open_driver(int32_t zero_code, int32_t full_scale_code) {
    const current_dac_options_t options = options_of(zero_code, full_scale_code);
    driver = current_dac_open(&options, &current, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(driver, error.text);
}

static void assert_code(const char *code) {
    TEST_ASSERT_EQUAL_STRING(code, scratch_read(DEVICE "/out_voltage0_raw"));
}

static void test_opening_and_closing_give_zero_current(void) {
    int32_t measured;
    open_driver(100, 65535);
    assert_code("100");
    TEST_ASSERT_FALSE(hal_current_read(&current, &measured));
    hal_current_write(&current, 3000, true);
    assert_code("65535");
    current_dac_close(driver);
    driver = NULL;
    assert_code("100");
}

static void test_current_becomes_the_nearest_code(void) {
    static const struct {
        int32_t current_mA;
        const char *code;
    } cases[] = {
        {0, "1000"},    {1, "1000"},    {2, "1001"},         {1500, "1500"},      {2999, "2000"},
        {3000, "2000"}, {3001, "2000"}, {INT32_MAX, "2000"}, {INT32_MIN, "1000"},
    };
    open_driver(1000, 2000);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        hal_current_write(&current, cases[i].current_mA, true);
        assert_code(cases[i].code);
    }
}

static void test_falling_codes_round_likewise(void) {
    open_driver(2000, 1000);
    hal_current_write(&current, 1, true);
    assert_code("2000");
    hal_current_write(&current, 2, true);
    assert_code("1999");
    hal_current_write(&current, 3000, true);
    assert_code("1000");
}

static void test_whole_range_of_codes_does_not_overflow(void) {
    open_driver(INT32_MIN, INT32_MAX);
    assert_code("-2147483648");
    hal_current_write(&current, 3000, true);
    assert_code("2147483647");
}

static void test_disabled_is_zero_current(void) {
    open_driver(1000, 2000);
    hal_current_write(&current, 3000, true);
    hal_current_write(&current, 3000, false);
    assert_code("1000");
}

static void test_dac_is_powered_up_after_zero_current(void) {
    scratch_write(DEVICE "/out_voltage0_powerdown", "1\n");
    open_driver(1000, 2000);
    TEST_ASSERT_EQUAL_STRING("0", scratch_read(DEVICE "/out_voltage0_powerdown"));
    assert_code("1000");
}

static void test_refused_writes_are_counted_and_tried_again(void) {
    struct rlimit before;
    const struct sigaction ignore = {.sa_handler = SIG_IGN};
    TEST_ASSERT_EQUAL_INT(0, sigaction(SIGXFSZ, &ignore, NULL));
    TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_FSIZE, &before));
    const struct rlimit none = {.rlim_cur = 0, .rlim_max = before.rlim_max};
    open_driver(1000, 2000);
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_FSIZE, &none));
    hal_current_write(&current, 3000, true);
    hal_current_write(&current, 3000, true);
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_FSIZE, &before));
    TEST_ASSERT_EQUAL_UINT32(2, current_dac_failures(driver));
    assert_code("1000");
    hal_current_write(&current, 3000, true);
    assert_code("2000");
    TEST_ASSERT_EQUAL_UINT32(2, current_dac_failures(driver));
}

static void disturb(const char *text) {
    scratch_write(DEVICE "/out_voltage0_raw", text);
}

static void test_disturbed_output_is_written_again_and_counted(void) {
    refresh_ms = 0;
    open_driver(1000, 2000);
    for (int i = 0; i < 60000; i++) {
        if (i == 30000) {
            disturb("2000");
        }
        hal_current_write(&current, 0, false);
    }
    assert_code("1000");
    TEST_ASSERT_EQUAL_UINT32(1, current_dac_failures(driver));
    hal_current_write(&current, 3000, true);
    disturb("1000");
    hal_current_write(&current, 3000, true);
    assert_code("2000");
    TEST_ASSERT_EQUAL_UINT32(2, current_dac_failures(driver));
}

static void test_steady_output_is_written_again_after_the_pause(void) {
    const struct timespec pause = {.tv_nsec = 2000000};
    refresh_ms = 1;
    open_driver(1000, 2000);
    hal_current_write(&current, 1500, true);
    disturb("1100");
    TEST_ASSERT_EQUAL_INT(0, nanosleep(&pause, NULL));
    hal_current_write(&current, 1500, true);
    assert_code("1500");
}

static void test_output_that_cannot_be_read_is_written_all_the_same(void) {
    refresh_ms = 0;
    TEST_ASSERT_EQUAL_INT(0, unlink(scratch_path(DEVICE "/out_voltage0_raw")));
    TEST_ASSERT_EQUAL_INT(0, symlink("/dev/null", scratch_path(DEVICE "/out_voltage0_raw")));
    open_driver(1000, 2000);
    hal_current_write(&current, 3000, true);
    hal_current_write(&current, 3000, true);
    TEST_ASSERT_EQUAL_UINT32(0, current_dac_failures(driver));
}

static void assert_refused(const current_dac_options_t *options, const char *part) {
    TEST_ASSERT_NULL(current_dac_open(options, &current, &error));
    assert_one_line(&error, part);
}

/// Stands for such a device: what is written in decimal is read in hexadecimal there.
static void test_output_that_does_not_hold_its_code_is_refused(void) {
    const current_dac_options_t options = options_of(100, 2000);
    const char *const raw = scratch_path(DEVICE "/out_voltage0_raw");
    TEST_ASSERT_EQUAL_INT(0, unlink(raw));
    TEST_ASSERT_EQUAL_INT(0, symlink("/proc/self/coredump_filter", raw));
    TEST_ASSERT_NULL(current_dac_open(&options, &current, &error));
    assert_one_line(&error, "does not hold the 100 that was written");
}

static void test_wrong_options_are_one_line(void) {
    current_dac_options_t options = options_of(0, 0);
    assert_refused(&options, "its code another one");
    options = options_of(0, 4095);
    options.full_scale_mA = 0;
    assert_refused(&options, "at least 1 mA");
    options = options_of(0, 4095);
    options.device = "iio:device9";
    assert_refused(&options, "IIO device 'iio:device9': there is none");
    options = options_of(0, 4095);
    options.channel = 3;
    assert_refused(&options, "out_voltage3_raw: No such file");
    TEST_ASSERT_EQUAL_INT(0, symlink("/dev/full", scratch_path(DEVICE "/out_voltage3_raw")));
    assert_refused(&options, "out_voltage3_raw: cannot write 0: No space left");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_opening_and_closing_give_zero_current);
    RUN_TEST(test_current_becomes_the_nearest_code);
    RUN_TEST(test_falling_codes_round_likewise);
    RUN_TEST(test_whole_range_of_codes_does_not_overflow);
    RUN_TEST(test_disabled_is_zero_current);
    RUN_TEST(test_dac_is_powered_up_after_zero_current);
    RUN_TEST(test_refused_writes_are_counted_and_tried_again);
    RUN_TEST(test_disturbed_output_is_written_again_and_counted);
    RUN_TEST(test_steady_output_is_written_again_after_the_pause);
    RUN_TEST(test_output_that_cannot_be_read_is_written_all_the_same);
    RUN_TEST(test_output_that_does_not_hold_its_code_is_refused);
    RUN_TEST(test_wrong_options_are_one_line);
    return UNITY_END();
}
