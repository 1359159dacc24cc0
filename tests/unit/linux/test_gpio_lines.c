// Real lines of the kernel's gpio-sim, once with each version of libgpiod: in the virtual machine,
// and wherever root may make a simulated chip.
#include "gpio.h"
#include "one_line.h"
#include "tick_linux.h"
#include "unity.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#define CONFIG "/sys/kernel/config/gpio-sim"
#define PATH_BYTES 256
#define PATIENCE_MS 20000 // only ever waited for where a test fails

static char folder[64];
static char chip[64];   ///< "gpiochip1"
static char lines[160]; ///< folder of the lines' levels
static char names[5][32];
static linux_error_t error;
static gpio_line_t *line;
static gpio_line_t *other;

static const char *place_of(int offset) {
    static char place[80];
    (void)snprintf(place, sizeof place, "%s:%d", chip, offset);
    return place;
}

static bool put(const char *path, const char *text) {
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const bool is_written = write(fd, text, strlen(text)) == (ssize_t)strlen(text);
    return close(fd) == 0 && is_written;
}

static void get(const char *path, char *text, size_t room) {
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    TEST_ASSERT_TRUE_MESSAGE(fd >= 0, path);
    const ssize_t bytes = read(fd, text, room - 1u);
    (void)close(fd);
    TEST_ASSERT_TRUE(bytes >= 0);
    text[bytes] = '\0';
    text[strcspn(text, "\n")] = '\0';
}

static void path_in(char path[PATH_BYTES], const char *name) {
    TEST_ASSERT_TRUE(snprintf(path, PATH_BYTES, "%s/%s", folder, name) < PATH_BYTES);
}

/// Four named lines, of which two have the same name, and four without.
static bool make_chip(void) {
    char path[PATH_BYTES];
    char device[64];
    (void)snprintf(folder, sizeof folder, CONFIG "/quiesce-%u", (unsigned int)getpid());
    if (mkdir(folder, 0755) != 0) {
        return false;
    }
    path_in(path, "bank0");
    TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
    path_in(path, "bank0/num_lines");
    TEST_ASSERT_TRUE(put(path, "8"));
    for (int i = 0; i < 4; i++) {
        char name[32];
        (void)snprintf(names[i], sizeof names[i], "Q%u-%d", (unsigned int)getpid(), i < 3 ? i : 2);
        (void)snprintf(name, sizeof name, "bank0/line%d", i);
        path_in(path, name);
        TEST_ASSERT_EQUAL_INT(0, mkdir(path, 0755));
        (void)snprintf(name, sizeof name, "bank0/line%d/name", i);
        path_in(path, name);
        TEST_ASSERT_TRUE(put(path, names[i]));
    }
    path_in(path, "live");
    TEST_ASSERT_TRUE(put(path, "1"));
    path_in(path, "dev_name");
    get(path, device, sizeof device);
    path_in(path, "bank0/chip_name");
    get(path, chip, sizeof chip);
    (void)snprintf(lines, sizeof lines, "/sys/devices/platform/%s/%s", device, chip);
    return true;
}

static void remove_chip(void) {
    char path[PATH_BYTES];
    path_in(path, "live");
    TEST_ASSERT_TRUE(put(path, "0"));
    for (int i = 0; i < 4; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "bank0/line%d", i);
        path_in(path, name);
        TEST_ASSERT_EQUAL_INT(0, rmdir(path));
    }
    path_in(path, "bank0");
    TEST_ASSERT_EQUAL_INT(0, rmdir(path));
    TEST_ASSERT_EQUAL_INT(0, rmdir(folder));
    folder[0] = '\0';
}

void setUp(void) {
    error.text[0] = '\0';
    line = NULL;
    other = NULL;
    if (!make_chip()) {
        folder[0] = '\0';
        TEST_IGNORE_MESSAGE("no simulated GPIO chips here (gpio-sim), or no right to make one");
    }
}

void tearDown(void) {
    gpio_close(line);
    gpio_close(other);
    if (folder[0] != '\0') {
        remove_chip();
    }
}

/// Level at the pin, whatever active-low makes of it.
static int level_of(int offset) {
    char path[PATH_BYTES];
    char text[8];
    (void)snprintf(path, sizeof path, "%s/sim_gpio%d/value", lines, offset);
    get(path, text, sizeof text);
    return text[0] - '0';
}

static void pull(int offset, bool is_up) {
    char path[PATH_BYTES];
    (void)snprintf(path, sizeof path, "%s/sim_gpio%d/pull", lines, offset);
    TEST_ASSERT_TRUE(put(path, is_up ? "pull-up" : "pull-down"));
}

static void open_output(gpio_spec_t spec, bool is_active) {
    line = gpio_open_output(&spec, is_active, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(line, error.text);
}

static void open_input(gpio_spec_t spec) {
    line = gpio_open_input(&spec, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(line, error.text);
}

static void assert_refused(const char *place, const char *part) {
    const gpio_spec_t spec = {.line = place};
    TEST_ASSERT_NULL(gpio_open_input(&spec, &error));
    assert_one_line(&error, part);
    TEST_ASSERT_NULL(gpio_open_output(&spec, false, &error));
    assert_one_line(&error, part);
}

static void test_output_has_its_level_from_the_opening_on(void) {
    gpio_edge_t edge;
    bool is_active = false;
    open_output((gpio_spec_t){.line = names[0]}, true);
    TEST_ASSERT_EQUAL_INT(1, level_of(0));
    TEST_ASSERT_TRUE(gpio_set(line, false));
    TEST_ASSERT_EQUAL_INT(0, level_of(0));
    TEST_ASSERT_TRUE(gpio_set(line, true));
    TEST_ASSERT_TRUE(gpio_get(line, &is_active) && is_active);
    TEST_ASSERT_EQUAL_INT(-1, gpio_fd(line));
    TEST_ASSERT_FALSE(gpio_next_edge(line, &edge));
}

static void test_active_low_output_is_inverted(void) {
    open_output((gpio_spec_t){.line = place_of(4), .is_active_low = true}, true);
    TEST_ASSERT_EQUAL_INT(0, level_of(4));
    TEST_ASSERT_TRUE(gpio_set(line, false));
    TEST_ASSERT_EQUAL_INT(1, level_of(4));
}

static void wait_for_edge(void) {
    struct pollfd wanted = {.fd = gpio_fd(line), .events = POLLIN};
    TEST_ASSERT_EQUAL_INT(1, poll(&wanted, 1, PATIENCE_MS));
}

static void assert_edges(bool is_active_low) {
    gpio_edge_t first;
    gpio_edge_t second;
    bool is_active;
    pull(1, false);
    open_input((gpio_spec_t){.line = names[1], .is_active_low = is_active_low});
    TEST_ASSERT_TRUE(gpio_get(line, &is_active));
    TEST_ASSERT_EQUAL(is_active_low, is_active);
    TEST_ASSERT_FALSE(gpio_next_edge(line, &first));
    const int64_t before_ns = tick_linux_now_ns();
    pull(1, true);
    wait_for_edge();
    TEST_ASSERT_TRUE(gpio_next_edge(line, &first));
    const int64_t between_ns = tick_linux_now_ns();
    pull(1, false);
    wait_for_edge();
    TEST_ASSERT_TRUE(gpio_next_edge(line, &second));
    TEST_ASSERT_FALSE(gpio_next_edge(line, &second));
    TEST_ASSERT_EQUAL(!is_active_low, first.is_active);
    TEST_ASSERT_EQUAL(is_active_low, second.is_active);
    TEST_ASSERT_TRUE(first.time_ns > before_ns && first.time_ns < between_ns);
    TEST_ASSERT_TRUE(second.time_ns > between_ns && second.time_ns < tick_linux_now_ns());
    gpio_close(line);
    line = NULL;
}

static void test_edges_have_levels_and_monotonic_times(void) {
    assert_edges(false);
    assert_edges(true);
}

static void test_bias_pulls_the_input(void) {
    bool is_active = false;
    pull(1, false);
    open_input((gpio_spec_t){.line = names[1], .bias = GPIO_BIAS_PULL_UP});
    TEST_ASSERT_TRUE(gpio_get(line, &is_active) && is_active);
    gpio_close(line);
    open_input((gpio_spec_t){.line = names[1], .bias = GPIO_BIAS_PULL_DOWN});
    TEST_ASSERT_TRUE(gpio_get(line, &is_active) && !is_active);
}

static void test_line_in_use_names_its_holder(void) {
    open_output((gpio_spec_t){.line = names[0]}, false);
    assert_refused(place_of(0), "in use by 'quiesced'");
    gpio_close(line);
    open_input((gpio_spec_t){.line = place_of(0)}); // free again
}

static void test_wrong_lines_are_one_line(void) {
    assert_refused(names[2], "2 lines have this name");
    assert_refused(place_of(8), "no such line");
    assert_refused("no such name", "has a line of this name");
}

static void test_chip_that_vanishes_is_told(void) {
    char path[PATH_BYTES];
    gpio_edge_t edge;
    bool is_active = true;
    open_input((gpio_spec_t){.line = names[1]});
    other = gpio_open_output(&(gpio_spec_t){.line = names[0]}, false, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(other, error.text);
    path_in(path, "live");
    TEST_ASSERT_TRUE(put(path, "0"));
    TEST_ASSERT_FALSE(gpio_get(line, &is_active));
    TEST_ASSERT_TRUE(is_active);
    TEST_ASSERT_FALSE(gpio_set(other, true));
    TEST_ASSERT_FALSE(gpio_next_edge(line, &edge));
    TEST_ASSERT_TRUE(put(path, "1")); // for tearDown
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_output_has_its_level_from_the_opening_on);
    RUN_TEST(test_active_low_output_is_inverted);
    RUN_TEST(test_edges_have_levels_and_monotonic_times);
    RUN_TEST(test_bias_pulls_the_input);
    RUN_TEST(test_line_in_use_names_its_holder);
    RUN_TEST(test_wrong_lines_are_one_line);
    RUN_TEST(test_chip_that_vanishes_is_told);
    return UNITY_END();
}
