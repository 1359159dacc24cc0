// Against the kernel's file interface in a folder; inotify tells the order of the writes. Untested
// on hardware.
#include "current_backends.h"
#include "one_line.h"
#include "scratch.h"
#include "unity.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/inotify.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define CHIP "pwm/pwmchip0"
#define CHANNEL CHIP "/pwm1"
#define NOBODY 65534
#define NEVER_MS 3600000u

static char root[SCRATCH_BYTES];
static char order[256];
static int watch;
static hal_current_t current;
static current_pwm_t *driver;
static uint32_t refresh_ms;
static linux_error_t error;

static void make_channel(const char *period, const char *duty, const char *enable,
                         const char *polarity) {
    scratch_folder(CHANNEL);
    scratch_write(CHANNEL "/period", period);
    scratch_write(CHANNEL "/duty_cycle", duty);
    scratch_write(CHANNEL "/enable", enable);
    if (polarity != NULL) {
        scratch_write(CHANNEL "/polarity", polarity);
    }
    TEST_ASSERT_TRUE(inotify_add_watch(watch, scratch_path(CHANNEL), IN_MODIFY) >= 0);
}

void setUp(void) {
    error.text[0] = '\0';
    driver = NULL;
    refresh_ms = NEVER_MS;
    scratch_make();
    scratch_folder(CHIP);
    scratch_write(CHIP "/npwm", "2\n");
    scratch_write(CHIP "/export", "");
    (void)snprintf(root, sizeof root, "%s", scratch_path("pwm"));
    watch = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    TEST_ASSERT_TRUE(watch >= 0);
}

void tearDown(void) {
    current_pwm_close(driver);
    (void)close(watch);
    scratch_remove();
}

/// Names of the files that were written since the last call, in order; a file that was written
/// several times in a row may be named once.
static const char *writes(void) {
    _Alignas(struct inotify_event) char events[4096];
    size_t length = 0;
    order[0] = '\0';
    const ssize_t bytes = read(watch, events, sizeof events);
    for (ssize_t at = 0; at < bytes;) {
        const struct inotify_event *const event =
            (const struct inotify_event *)(const void *)&events[at];
        length += (size_t)snprintf(&order[length], sizeof order - length, "%s%s",
                                   length > 0 ? " " : "", event->name);
        TEST_ASSERT_TRUE(length < sizeof order);
        at += (ssize_t)(sizeof *event + event->len);
    }
    return order;
}

static current_pwm_options_t options_of(bool is_inverted) {
    return (current_pwm_options_t){
        .chip = "pwmchip0",
        .channel = 1,
        .period_ns = 50000,
        .full_scale_mA = 3000,
        .refresh_ms = refresh_ms,
        .is_inverted = is_inverted,
        .sysfs_root = root,
    };
}

static void open_driver(bool is_inverted) {
    const current_pwm_options_t options = options_of(is_inverted);
    driver = current_pwm_open(&options, &current, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(driver, error.text);
}

static void assert_output(const char *duty, const char *enable) {
    TEST_ASSERT_EQUAL_STRING(duty, scratch_read(CHANNEL "/duty_cycle"));
    TEST_ASSERT_EQUAL_STRING(enable, scratch_read(CHANNEL "/enable"));
}

static void test_opening_gives_zero_current_and_the_output_off(void) {
    make_channel("0\n", "0\n", "0\n", "normal\n");
    open_driver(false);
    TEST_ASSERT_EQUAL_STRING("50000", scratch_read(CHANNEL "/period"));
    assert_output("0", "0");
    int32_t measured;
    TEST_ASSERT_FALSE(hal_current_read(&current, &measured));
}

static void test_opening_of_a_running_output_stops_it_first(void) {
    make_channel("90000\n", "80000\n", "1\n", "inversed\n");
    open_driver(false);
    const char *const seen = writes();
    TEST_ASSERT_EQUAL_STRING_LEN("enable duty_cycle period enable polarity duty_cycle", seen,
                                 strlen("enable duty_cycle period enable polarity duty_cycle"));
    TEST_ASSERT_EQUAL_STRING_LEN("normal", scratch_read(CHANNEL "/polarity"), 6);
    assert_output("0", "0");
}

static void test_duty_is_right_before_the_output_goes_on(void) {
    make_channel("0\n", "0\n", "0\n", NULL);
    open_driver(false);
    (void)writes();
    hal_current_write(&current, 1500, true);
    TEST_ASSERT_EQUAL_STRING("duty_cycle enable", writes());
    assert_output("25000", "1");
    hal_current_write(&current, 1500, true);
    TEST_ASSERT_EQUAL_STRING("", writes()); // nothing has changed
    hal_current_write(&current, 1501, true);
    TEST_ASSERT_EQUAL_STRING("duty_cycle", writes());
    hal_current_write(&current, 1501, false);
    TEST_ASSERT_EQUAL_STRING("enable duty_cycle", writes());
    assert_output("0", "0");
}

static void test_current_is_limited_and_rounded_to_nearest(void) {
    static const struct {
        int32_t current_mA;
        const char *duty;
    } cases[] = {
        {1, "17"}, {2, "33"}, {3000, "50000"},  {3001, "50000"}, {INT32_MAX, "50000"},
        {0, "0"},  {-1, "0"}, {INT32_MIN, "0"}, {2999, "49983"},
    };
    make_channel("0\n", "0\n", "0\n", NULL);
    open_driver(false);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        hal_current_write(&current, cases[i].current_mA, true);
        TEST_ASSERT_EQUAL_STRING(cases[i].duty, scratch_read(CHANNEL "/duty_cycle"));
    }
    TEST_ASSERT_EQUAL_UINT32(0, current_pwm_failures(driver));
}

static void test_inverted_driver_is_never_switched_off(void) {
    make_channel("0\n", "0\n", "0\n", "normal\n");
    open_driver(true);
    assert_output("50000", "1");
    (void)writes();
    hal_current_write(&current, 750, true);
    TEST_ASSERT_EQUAL_STRING("duty_cycle", writes());
    assert_output("37500", "1");
    hal_current_write(&current, 3000, true);
    assert_output("0", "1");
    hal_current_write(&current, 750, false);
    assert_output("50000", "1");
    hal_current_write(&current, 2000, true);
    current_pwm_close(driver);
    driver = NULL;
    assert_output("50000", "1");
}

static void test_inverted_driver_that_runs_is_never_at_less_duty(void) {
    make_channel("90000\n", "90000\n", "1\n", "normal\n");
    open_driver(true);
    const char *const seen = writes();
    TEST_ASSERT_EQUAL_STRING_LEN("duty_cycle period duty_cycle", seen,
                                 strlen("duty_cycle period duty_cycle"));
    assert_output("50000", "1");
}

static void test_close_leaves_zero_current(void) {
    make_channel("0\n", "0\n", "0\n", NULL);
    open_driver(false);
    hal_current_write(&current, 3000, true);
    current_pwm_close(driver);
    driver = NULL;
    assert_output("0", "1");
}

/// Writes fail for the body's time: files must not grow.
static void with_refused_writes(void (*body)(void)) {
    struct rlimit before;
    const struct sigaction ignore = {.sa_handler = SIG_IGN};
    TEST_ASSERT_EQUAL_INT(0, sigaction(SIGXFSZ, &ignore, NULL));
    TEST_ASSERT_EQUAL_INT(0, getrlimit(RLIMIT_FSIZE, &before));
    const struct rlimit none = {.rlim_cur = 0, .rlim_max = before.rlim_max};
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_FSIZE, &none));
    body();
    TEST_ASSERT_EQUAL_INT(0, setrlimit(RLIMIT_FSIZE, &before));
}

static void command_twice(void) {
    hal_current_write(&current, 3000, true);
    hal_current_write(&current, 3000, true);
}

static void switch_off(void) {
    hal_current_write(&current, 0, false);
}

static void test_refused_writes_are_counted_and_tried_again(void) {
    make_channel("0\n", "0\n", "0\n", NULL);
    open_driver(false);
    with_refused_writes(command_twice);
    TEST_ASSERT_EQUAL_UINT32(2, current_pwm_failures(driver)); // the output stays off
    assert_output("0", "0");
    hal_current_write(&current, 3000, true);
    assert_output("50000", "1");
    with_refused_writes(switch_off);
    TEST_ASSERT_EQUAL_UINT32(4, current_pwm_failures(driver)); // both are tried
    hal_current_write(&current, 0, false);
    TEST_ASSERT_EQUAL_UINT32(4, current_pwm_failures(driver));
    assert_output("0", "0");
}

static void test_disturbed_output_is_written_again_and_counted(void) {
    refresh_ms = 0;
    make_channel("0\n", "0\n", "0\n", NULL);
    open_driver(false);
    for (int i = 0; i < 60000; i++) {
        if (i == 30000) {
            scratch_write(CHANNEL "/duty_cycle", "50000\n");
            scratch_write(CHANNEL "/enable", "1\n");
        }
        hal_current_write(&current, 0, false);
    }
    assert_output("0", "0");
    TEST_ASSERT_EQUAL_UINT32(2, current_pwm_failures(driver)); // both
    hal_current_write(&current, 1500, true);
    scratch_write(CHANNEL "/enable", "0\n");
    hal_current_write(&current, 1500, true);
    assert_output("25000", "1");
    TEST_ASSERT_EQUAL_UINT32(3, current_pwm_failures(driver));
}

static void test_disturbed_inverted_output_is_written_again_and_counted(void) {
    refresh_ms = 0;
    make_channel("0\n", "0\n", "0\n", "normal\n");
    open_driver(true);
    scratch_write(CHANNEL "/duty_cycle", "0\n"); // full current
    hal_current_write(&current, 0, false);
    assert_output("50000", "1");
    TEST_ASSERT_EQUAL_UINT32(1, current_pwm_failures(driver));
}

/// Else the kernel, which compares with what it believes, would not write to the chip.
static void test_refresh_of_a_steady_duty_goes_beside_it(void) {
    refresh_ms = 0;
    make_channel("0\n", "0\n", "0\n", NULL);
    open_driver(false);
    hal_current_write(&current, 1500, true);
    (void)writes();
    hal_current_write(&current, 1500, true);
    // One name for the two writes in a row.
    TEST_ASSERT_EQUAL_STRING("duty_cycle enable", writes());
    assert_output("25000", "1");
    TEST_ASSERT_EQUAL_UINT32(0, current_pwm_failures(driver));
}

static void assert_refused(const current_pwm_options_t *options, const char *part) {
    TEST_ASSERT_NULL(current_pwm_open(options, &current, &error));
    assert_one_line(&error, part);
}

static void test_wrong_options_are_one_line(void) {
    current_pwm_options_t options = options_of(false);
    options.chip = NULL;
    assert_refused(&options, "give it as pwmchip0");
    options.chip = "../pwmchip0";
    assert_refused(&options, "give it as pwmchip0");
    options.chip = "pwmchip7";
    assert_refused(&options, "PWM chip 'pwmchip7': there is none");
    options = options_of(false);
    options.channel = 2;
    assert_refused(&options, "channel 2: it has 0 .. 1");
    options = options_of(false);
    options.period_ns = 0;
    assert_refused(&options, "must be at least 1");
    options = options_of(false);
    options.full_scale_mA = 0;
    assert_refused(&options, "must be at least 1");
}

static void test_channel_that_does_not_appear_is_one_line(void) {
    const current_pwm_options_t options = options_of(false);
    assert_refused(&options, "channel 1 did not appear");
    TEST_ASSERT_EQUAL_STRING("1", scratch_read(CHIP "/export"));
    TEST_ASSERT_EQUAL_INT(0, unlink(scratch_path(CHIP "/export")));
    assert_refused(&options, "cannot export channel 1: No such file");
}

static void test_malformed_files_are_one_line(void) {
    static const char *const contents[] = {
        "", "\n", "text\n", "-1\n", "1.5\n", "0x10\n", "99999999999999999999\n"};
    static const char *const files[] = {CHANNEL "/enable", CHANNEL "/duty_cycle"};
    const current_pwm_options_t options = options_of(false);
    for (size_t i = 0; i < sizeof contents / sizeof contents[0]; i++) {
        for (size_t k = 0; k < 2u; k++) {
            make_channel("0\n", "0\n", "0\n", NULL);
            scratch_write(files[k], contents[i]);
            assert_refused(&options, "not the number that a PWM has there");
        }
        scratch_write(CHIP "/npwm", contents[i]);
        assert_refused(&options, "there is none");
        scratch_write(CHIP "/npwm", "2\n");
    }
    make_channel("0\n", "0\n", "0\n", NULL);
    TEST_ASSERT_EQUAL_INT(0, unlink(scratch_path(CHANNEL "/period")));
    assert_refused(&options, "period: cannot write 50000: No such file");
    TEST_ASSERT_EQUAL_INT(0, symlink("/dev/full", scratch_path(CHANNEL "/period")));
    assert_refused(&options, "No space left");
}

/// Of all files of the channel.
static void set_rights(mode_t mode) {
    static const char *const files[] = {"/period", "/duty_cycle", "/enable"};
    for (size_t i = 0; i < 3u; i++) {
        char name[SCRATCH_BYTES];
        (void)snprintf(name, sizeof name, "%s%s", CHANNEL, files[i]);
        TEST_ASSERT_EQUAL_INT(0, chmod(scratch_path(name), mode));
    }
}

/// Opens in a process that is not root, as the service; its end code is 0 where that succeeds, and
/// the pipe gets a byte before and the error's text after it.
static pid_t open_in_child(int talk[2]) {
    TEST_ASSERT_EQUAL_INT(0, chmod(scratch_path("."), 0755));
    TEST_ASSERT_EQUAL_INT(0, pipe(talk));
    const pid_t child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        const current_pwm_options_t options = options_of(false);
        const bool is_user = geteuid() != 0 || setresuid(NOBODY, NOBODY, NOBODY) == 0;
        const bool is_told = write(talk[1], "!", 1) == 1;
        const bool is_open =
            is_user && is_told && current_pwm_open(&options, &current, &error) != NULL;
        const ssize_t length = (ssize_t)strlen(error.text);
        _exit(write(talk[1], error.text, (size_t)length) == length && is_open ? 0 : 1);
    }
    TEST_ASSERT_EQUAL_INT(0, close(talk[1]));
    char told;
    TEST_ASSERT_EQUAL_INT(1, read(talk[0], &told, 1));
    return child;
}

static int end_code(pid_t child) {
    int status;
    TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
    TEST_ASSERT_TRUE(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/// Letter of /proc/PID/stat: S where it sleeps, Z where it has ended.
static char state_of(pid_t child) {
    char path[64];
    char state = '?';
    (void)snprintf(path, sizeof path, "/proc/%d/stat", (int)child);
    FILE *const file = fopen(path, "re");
    TEST_ASSERT_NOT_NULL(file);
    TEST_ASSERT_EQUAL_INT(1, fscanf(file, "%*d (%*[^)]) %c", &state));
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    return state;
}

static void test_opening_waits_for_the_rights(void) {
    int talk[2];
    make_channel("0\n", "0\n", "0\n", NULL);
    set_rights(0444);
    const pid_t child = open_in_child(talk);
    char state;
    do {
        state = state_of(child);
    } while (state != 'S' && state != 'Z'); // all that it sleeps for is the rights
    TEST_ASSERT_EQUAL_CHAR('S', state);
    TEST_ASSERT_EQUAL_STRING("", writes());
    set_rights(0666);
    TEST_ASSERT_EQUAL_INT(0, end_code(child));
    TEST_ASSERT_EQUAL_INT(0, close(talk[0]));
    TEST_ASSERT_EQUAL_STRING("50000", scratch_read(CHANNEL "/period"));
    assert_output("0", "0");
}

static void test_rights_that_do_not_come_are_one_line(void) {
    int talk[2];
    make_channel("0\n", "0\n", "0\n", NULL);
    set_rights(0444);
    const pid_t child = open_in_child(talk);
    TEST_ASSERT_EQUAL_INT(1, end_code(child));
    const ssize_t bytes = read(talk[0], error.text, sizeof error.text - 1u);
    TEST_ASSERT_TRUE(bytes > 0);
    error.text[bytes] = '\0';
    TEST_ASSERT_EQUAL_INT(0, close(talk[0]));
    assert_one_line(&error, "period: cannot write 50000: Permission denied");
    TEST_ASSERT_EQUAL_STRING("", writes());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_opening_gives_zero_current_and_the_output_off);
    RUN_TEST(test_opening_of_a_running_output_stops_it_first);
    RUN_TEST(test_duty_is_right_before_the_output_goes_on);
    RUN_TEST(test_current_is_limited_and_rounded_to_nearest);
    RUN_TEST(test_inverted_driver_is_never_switched_off);
    RUN_TEST(test_inverted_driver_that_runs_is_never_at_less_duty);
    RUN_TEST(test_close_leaves_zero_current);
    RUN_TEST(test_refused_writes_are_counted_and_tried_again);
    RUN_TEST(test_disturbed_output_is_written_again_and_counted);
    RUN_TEST(test_disturbed_inverted_output_is_written_again_and_counted);
    RUN_TEST(test_refresh_of_a_steady_duty_goes_beside_it);
    RUN_TEST(test_wrong_options_are_one_line);
    RUN_TEST(test_channel_that_does_not_appear_is_one_line);
    RUN_TEST(test_malformed_files_are_one_line);
    RUN_TEST(test_opening_waits_for_the_rights);
    RUN_TEST(test_rights_that_do_not_come_are_one_line);
    return UNITY_END();
}
