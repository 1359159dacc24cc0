// SLCAN over ptys: the test is the adapter, at the other end.
#include "can_bus.h"
#include "one_line.h"
#include "scratch.h"
#include "slcan.h"
#include "unity.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <pty.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#define PATIENCE_MS 20000 // only ever waited for where a test fails

static int adapter; ///< master end
static int keeper;  ///< slave end, so that the line is there while nobody has opened it
static can_bus_t *bus;
static linux_error_t error;
static char line[SCRATCH_BYTES];

static void plug_in(void) {
    char name[64];
    TEST_ASSERT_EQUAL_INT(0, openpty(&adapter, &keeper, name, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(0, fcntl(adapter, F_SETFL, O_NONBLOCK));
    (void)unlink(scratch_path("tty"));
    TEST_ASSERT_EQUAL_INT(0, symlink(name, scratch_path("tty")));
}

static void unplug(void) {
    (void)close(adapter);
    (void)close(keeper);
    adapter = -1;
}

void setUp(void) {
    error.text[0] = '\0';
    bus = NULL;
    scratch_make();
    plug_in();
    (void)snprintf(line, sizeof line, "slcan:%s", scratch_path("tty"));
}

void tearDown(void) {
    can_bus_close(bus);
    if (adapter >= 0) {
        unplug();
    }
    scratch_remove();
}

static void open_bus(can_bus_options_t options) {
    options.interface = line;
    bus = can_bus_open(&options, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(bus, error.text);
    TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
}

static void wait_for(int fd, short events) {
    struct pollfd wanted = {.fd = fd, .events = events};
    TEST_ASSERT_EQUAL_INT(1, poll(&wanted, 1, PATIENCE_MS));
}

/// The adapter sends; waits while the line is full.
static void tell(const void *bytes, size_t count) {
    const uint8_t *at = bytes;
    while (count > 0u) {
        const ssize_t put = write(adapter, at, count);
        if (put < 0) {
            TEST_ASSERT_EQUAL_INT(EAGAIN, errno);
            wait_for(adapter, POLLOUT);
            continue;
        }
        at += put;
        count -= (size_t)put;
    }
}

static void tell_text(const char *text) {
    tell(text, strlen(text));
}

/// The adapter takes exactly so many bytes.
static void hear(char *text, size_t count) {
    size_t got = 0;
    while (got < count) {
        wait_for(adapter, POLLIN);
        const ssize_t more = read(adapter, &text[got], count - got);
        TEST_ASSERT_TRUE(more > 0);
        got += (size_t)more;
    }
    text[count] = '\0';
}

static can_frame_t next_frame(void) {
    can_frame_t frame;
    while (!can_bus_receive(bus, &frame, NULL)) {
        wait_for(can_bus_fd(bus), POLLIN);
    }
    return frame;
}

static void test_frames_go_both_ways(void) {
    const can_frame_t out = {.id = 0x123, .length = 2, .data = {0xAB, 0x01}};
    char text[32];
    open_bus((can_bus_options_t){.serial_baud = 115200});
    TEST_ASSERT_TRUE(can_bus_send(bus, &out));
    hear(text, strlen("t1232AB01\r"));
    TEST_ASSERT_EQUAL_STRING("t1232AB01\r", text);
    tell_text("t01030102ff\rT1ABCDEF01");
    tell_text("55\r"); // a line in two pieces
    const can_frame_t first = next_frame();
    TEST_ASSERT_EQUAL_HEX32(0x10, first.id);
    TEST_ASSERT_EQUAL_HEX8(0xFF, first.data[2]);
    TEST_ASSERT_EQUAL_HEX32(0x1ABCDEF0, next_frame().id);
    TEST_ASSERT_EQUAL_UINT32(2, can_bus_counters(bus)->received);
    TEST_ASSERT_EQUAL_UINT32(1, can_bus_counters(bus)->sent);
    TEST_ASSERT_EQUAL_UINT32(0, can_bus_counters(bus)->malformed);
}

static void test_times_never_go_back(void) {
    can_frame_t frame;
    int64_t before_ns = 0;
    open_bus((can_bus_options_t){0});
    for (int i = 0; i < 20; i++) {
        int64_t time_ns = 0;
        tell_text("t0100\rt0110\r");
        for (int k = 0; k < 2; k++) {
            while (!can_bus_receive(bus, &frame, &time_ns)) {
                wait_for(can_bus_fd(bus), POLLIN);
            }
            TEST_ASSERT_TRUE(time_ns >= before_ns);
            before_ns = time_ns;
        }
    }
}

static void test_only_wanted_ids_arrive(void) {
    static const uint32_t ids[] = {0x010, 0x7FF};
    open_bus((can_bus_options_t){.ids = ids, .id_count = 2});
    tell_text("t0110\rT000000100\rr0100\rt7FE0\rt0100\rt7FF0\r");
    TEST_ASSERT_EQUAL_HEX32(0x010, next_frame().id);
    TEST_ASSERT_EQUAL_HEX32(0x7FF, next_frame().id);
    TEST_ASSERT_EQUAL_UINT32(2, can_bus_counters(bus)->received);
}

static void test_hostile_bytes_are_counted_and_pass(void) {
    uint8_t all[256];
    uint32_t seed = 1;
    for (size_t i = 0; i < sizeof all; i++) {
        all[i] = (uint8_t)i;
    }
    open_bus((can_bus_options_t){0});
    tell(all, sizeof all);
    for (int i = 0; i < 64; i++) { // 16 KiB: several times what the line holds
        can_frame_t frame;
        for (size_t k = 0; k < sizeof all; k++) {
            seed = seed * 1664525u + 1013904223u;
            all[k] = (uint8_t)(seed >> 24);
        }
        tell(all, sizeof all);
        while (can_bus_receive(bus, &frame, NULL)) {
        }
    }
    tell_text("\rt123\rt9990\rt12390102\rtttttttttttttttttttttttttttttttt\rt5A5155\r");
    can_frame_t frame = next_frame();
    while (frame.id != 0x5A5) { // noise may hold a frame
        frame = next_frame();
    }
    TEST_ASSERT_EQUAL_HEX8(0x55, frame.data[0]);
    TEST_ASSERT_TRUE(can_bus_counters(bus)->malformed >= 4u);
    TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
}

static int waiting_bytes(void) {
    int count = 0;
    TEST_ASSERT_EQUAL_INT(0, ioctl(keeper, FIONREAD, &count));
    return count;
}

static void test_one_call_takes_a_bounded_number_of_bytes(void) {
    static char noise[3900];
    can_frame_t frame;
    memset(noise, 'x', sizeof noise);
    open_bus((can_bus_options_t){0});
    tell(noise, sizeof noise);
    while (waiting_bytes() < (int)sizeof noise) { // the kernel hands them over in its own time
        (void)sched_yield();
    }
    TEST_ASSERT_FALSE(can_bus_receive(bus, &frame, NULL));
    TEST_ASSERT_EQUAL_INT((int)sizeof noise - 4 * 512, waiting_bytes());
    tell_text("\rt0100\r");
    TEST_ASSERT_EQUAL_HEX32(0x010, next_frame().id);
    TEST_ASSERT_EQUAL_UINT32(1, can_bus_counters(bus)->malformed);
}

static void test_refusal_of_the_adapter_ends_its_line(void) {
    open_bus((can_bus_options_t){0});
    tell_text("\at0100\r\a\az\rt0111AA\r");
    TEST_ASSERT_EQUAL_HEX32(0x010, next_frame().id);
    TEST_ASSERT_EQUAL_HEX32(0x011, next_frame().id);
    TEST_ASSERT_EQUAL_UINT32(3, can_bus_counters(bus)->error_frames);
    TEST_ASSERT_EQUAL_UINT32(0, can_bus_counters(bus)->malformed);
}

static void test_adapter_is_set_opened_and_closed(void) {
    char text[32];
    open_bus((can_bus_options_t){.bitrate = 500000});
    hear(text, strlen("C\rS6\rO\r"));
    TEST_ASSERT_EQUAL_STRING("C\rS6\rO\r", text);
    can_bus_close(bus);
    bus = NULL;
    hear(text, 2);
    TEST_ASSERT_EQUAL_STRING("C\r", text);
}

static void test_line_is_raw_at_the_speed_that_was_asked_for(void) {
    struct termios set;
    // QEMU's user mode, which runs this for arm64, passes on no higher one.
    open_bus((can_bus_options_t){.serial_baud = 460800});
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(keeper, &set));
    TEST_ASSERT_EQUAL_UINT32(B460800, cfgetospeed(&set));
    TEST_ASSERT_EQUAL_UINT32(B460800, cfgetispeed(&set));
    TEST_ASSERT_EQUAL_UINT32(0, set.c_lflag & (ICANON | ECHO | ISIG));
    TEST_ASSERT_EQUAL_UINT32(0, set.c_iflag & (IXON | ICRNL));
}

static void test_what_was_there_before_the_opening_is_dropped(void) {
    char text[4];
    struct termios raw;
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(keeper, &raw));
    cfmakeraw(&raw);
    TEST_ASSERT_EQUAL_INT(0, tcsetattr(keeper, TCSANOW, &raw));
    tell_text("!t0990\r");
    TEST_ASSERT_EQUAL_INT(1, read(keeper, text, 1)); // so it has arrived
    open_bus((can_bus_options_t){0});
    tell_text("t0100\r");
    TEST_ASSERT_EQUAL_HEX32(0x010, next_frame().id);
}

static void test_full_line_drops_whole_frames(void) {
    const uint32_t frames = 2000;
    uint32_t taken = 0;
    uint32_t heard = 0;
    slcan_decoder_t decoder;
    open_bus((can_bus_options_t){0});
    for (uint32_t i = 0; i < frames; i++) {
        const can_frame_t frame = {.id = i % 0x700u, .length = 8};
        taken += can_bus_send(bus, &frame) ? 1u : 0u;
    }
    TEST_ASSERT_TRUE(taken > 0u && taken < frames);
    TEST_ASSERT_EQUAL_UINT32(taken, can_bus_counters(bus)->sent);
    TEST_ASSERT_EQUAL_UINT32(frames - taken, can_bus_counters(bus)->tx_dropped);
    slcan_decoder_init(&decoder);
    uint32_t extra = 0; // sent meanwhile: it pushes out the rest of a line that was begun
    while (heard < taken + extra) {
        char bytes[256];
        can_frame_t frame;
        wait_for(adapter, POLLIN);
        const ssize_t count = read(adapter, bytes, sizeof bytes);
        TEST_ASSERT_TRUE(count > 0);
        for (ssize_t i = 0; i < count; i++) {
            heard += slcan_decode(&decoder, (uint8_t)bytes[i], &frame) ? 1u : 0u;
        }
        const can_frame_t more = {.id = 0x7AA};
        extra += extra == 0u && can_bus_send(bus, &more) ? 1u : 0u;
    }
    TEST_ASSERT_EQUAL_UINT32(0, decoder.malformed_count + decoder.ignored_count);
}

static void test_line_that_vanishes_is_found_again(void) {
    can_frame_t frame = {.id = 0x10};
    int64_t now_ns = 1;
    open_bus((can_bus_options_t){.bitrate = 1000000});
    for (uint32_t round = 1; round <= 3; round++) {
        char text[8];
        unplug();
        while (can_bus_state(bus) != CAN_BUS_DOWN) { // noticed by reading or by sending
            TEST_ASSERT_FALSE(can_bus_receive(bus, &frame, NULL));
            (void)can_bus_send(bus, &frame);
        }
        TEST_ASSERT_EQUAL_INT(-1, can_bus_fd(bus));
        TEST_ASSERT_FALSE(can_bus_send(bus, &frame));
        TEST_ASSERT_FALSE(can_bus_receive(bus, &frame, NULL));
        TEST_ASSERT_EQUAL_UINT32(round, can_bus_counters(bus)->down);
        TEST_ASSERT_EQUAL_STRING("serial line is gone", can_bus_last_event(bus)->text);
        can_bus_repair(bus, now_ns);
        TEST_ASSERT_EQUAL(CAN_BUS_DOWN, can_bus_state(bus));
        plug_in();
        can_bus_repair(bus, now_ns + 1); // not yet
        TEST_ASSERT_EQUAL(CAN_BUS_DOWN, can_bus_state(bus));
        now_ns += INT64_C(1000000000);
        can_bus_repair(bus, now_ns);
        TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
        TEST_ASSERT_EQUAL_STRING("serial line is back", can_bus_last_event(bus)->text);
        TEST_ASSERT_EQUAL_UINT32(2u * round, can_bus_last_event(bus)->number);
        hear(text, strlen("C\rS8\rO\r"));
        tell_text("t0100\r");
        TEST_ASSERT_EQUAL_HEX32(0x010, next_frame().id);
    }
}

static void notice_that_it_is_gone(void) {
    can_frame_t frame = {.id = 0x10};
    while (can_bus_state(bus) != CAN_BUS_DOWN) {
        TEST_ASSERT_FALSE(can_bus_receive(bus, &frame, NULL));
        (void)can_bus_send(bus, &frame);
    }
}

/// The user's part opens and closes nothing, however often it is called.
static void test_user_waits_for_nothing_while_another_thread_recovers(void) {
    const can_frame_t frame = {.id = 0x10};
    char text[8];
    open_bus((can_bus_options_t){.bitrate = 500000});
    const int fd = can_bus_fd(bus);
    unplug();
    notice_that_it_is_gone();
    TEST_ASSERT_NOT_EQUAL(-1, fcntl(fd, F_GETFD)); // closing may block: it is still open
    plug_in();
    const uint32_t dropped = can_bus_counters(bus)->tx_dropped;
    TEST_ASSERT_TRUE(can_bus_maintain(bus, 1));
    for (uint32_t i = 1; i <= 3; i++) {
        TEST_ASSERT_FALSE(can_bus_maintain(bus, INT64_MAX / 2)); // asked for already
        TEST_ASSERT_FALSE(can_bus_send(bus, &frame));
        TEST_ASSERT_EQUAL_UINT32(dropped + i, can_bus_counters(bus)->tx_dropped);
    }
    TEST_ASSERT_NOT_EQUAL(-1, fcntl(fd, F_GETFD));
    // Nobody has opened the new line: that would have sent commands.
    TEST_ASSERT_EQUAL_INT(0, poll(&(struct pollfd){.fd = adapter, .events = POLLIN}, 1, 0));

    can_bus_recover(bus); // what the other thread does
    TEST_ASSERT_EQUAL(CAN_BUS_DOWN, can_bus_state(bus));
    TEST_ASSERT_FALSE(can_bus_send(bus, &frame));
    TEST_ASSERT_EQUAL_STRING("serial line is gone", can_bus_last_event(bus)->text);
    TEST_ASSERT_FALSE(can_bus_maintain(bus, 2));
    TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
    TEST_ASSERT_EQUAL_STRING("serial line is back", can_bus_last_event(bus)->text);
    TEST_ASSERT_TRUE(can_bus_send(bus, &frame));
    hear(text, strlen("C\rS6\rO\r"));
    can_bus_recover(bus); // nothing is wrong
    TEST_ASSERT_TRUE(can_bus_send(bus, &frame));
}

static void test_bus_may_be_closed_at_any_stage_of_its_recovery(void) {
    for (int stage = 0; stage < 3; stage++) {
        open_bus((can_bus_options_t){0});
        const int fd = can_bus_fd(bus);
        unplug();
        notice_that_it_is_gone();
        plug_in();
        if (stage > 0) {
            TEST_ASSERT_TRUE(can_bus_maintain(bus, 1));
        }
        if (stage > 1) {
            can_bus_recover(bus);
        }
        can_bus_close(bus);
        bus = NULL;
        TEST_ASSERT_TRUE(fcntl(fd, F_GETFD) == -1 || fd == adapter || fd == keeper);
        open_bus((can_bus_options_t){0}); // no lock was left on the line
        can_bus_close(bus);
        bus = NULL;
    }
}

static atomic_bool is_over;

static void *recover_again_and_again(void *unused) {
    while (!atomic_load(&is_over)) {
        can_bus_recover(bus);
        (void)sched_yield();
    }
    return unused;
}

/// The user's calls of a tick; it never waits for the other thread.
static void use_until(can_bus_state_t state, int64_t *now_ns) {
    const can_frame_t out = {.id = 0x10};
    can_frame_t in;
    while (can_bus_state(bus) != state) {
        (void)can_bus_receive(bus, &in, NULL);
        (void)can_bus_send(bus, &out);
        *now_ns += INT64_C(1000000);
        (void)can_bus_maintain(bus, *now_ns);
        (void)sched_yield();
    }
}

static void test_two_threads_share_the_recovery(void) {
    pthread_t other;
    int64_t now_ns = 1;
    open_bus((can_bus_options_t){0});
    atomic_store(&is_over, false);
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&other, NULL, recover_again_and_again, NULL));
    for (uint32_t round = 1; round <= 50; round++) {
        unplug();
        use_until(CAN_BUS_DOWN, &now_ns);
        plug_in();
        use_until(CAN_BUS_UP, &now_ns);
        TEST_ASSERT_EQUAL_UINT32(round, can_bus_counters(bus)->down);
        tell_text("t0100\r");
        TEST_ASSERT_EQUAL_HEX32(0x010, next_frame().id);
    }
    atomic_store(&is_over, true);
    TEST_ASSERT_EQUAL_INT(0, pthread_join(other, NULL));
    TEST_ASSERT_EQUAL_UINT32(100, can_bus_last_event(bus)->number);
}

static void assert_refused(const can_bus_options_t *options, const char *part) {
    TEST_ASSERT_NULL(can_bus_open(options, &error));
    assert_one_line(&error, part);
}

static void test_wrong_options_are_one_line(void) {
    char path[300];
    memset(path, 'a', sizeof path - 1u);
    memcpy(path, "slcan:/", 7);
    path[sizeof path - 1u] = '\0';
    assert_refused(&(can_bus_options_t){.interface = path}, "too long");
    assert_refused(&(can_bus_options_t){.interface = "slcan:/dev/no-such-line"},
                   "no such serial line");
    assert_refused(&(can_bus_options_t){.interface = "slcan:"}, "no such serial line");
    assert_refused(&(can_bus_options_t){.interface = "slcan:/dev/null"}, "no serial line");
    assert_refused(&(can_bus_options_t){.interface = line, .use_fd = true}, "no CAN FD");
    assert_refused(&(can_bus_options_t){.interface = line, .serial_baud = 115201}, "115201 baud");
    assert_refused(&(can_bus_options_t){.interface = line, .bitrate = 499999}, "499999 bit/s");
}

static void test_line_in_use_is_refused(void) {
    open_bus((can_bus_options_t){0});
    assert_refused(&(can_bus_options_t){.interface = line}, "in use by another process");
    can_bus_close(bus);
    open_bus((can_bus_options_t){0});
}

static void test_frame_that_is_none_is_dropped(void) {
    const can_frame_t too_long = {.id = 1, .length = 9};
    const can_frame_t no_id = {.id = 0x800};
    open_bus((can_bus_options_t){0});
    TEST_ASSERT_FALSE(can_bus_send(bus, &too_long));
    TEST_ASSERT_FALSE(can_bus_send(bus, &no_id));
    TEST_ASSERT_EQUAL_UINT32(2, can_bus_counters(bus)->tx_dropped);
    TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_frames_go_both_ways);
    RUN_TEST(test_times_never_go_back);
    RUN_TEST(test_only_wanted_ids_arrive);
    RUN_TEST(test_hostile_bytes_are_counted_and_pass);
    RUN_TEST(test_one_call_takes_a_bounded_number_of_bytes);
    RUN_TEST(test_refusal_of_the_adapter_ends_its_line);
    RUN_TEST(test_adapter_is_set_opened_and_closed);
    RUN_TEST(test_line_is_raw_at_the_speed_that_was_asked_for);
    RUN_TEST(test_what_was_there_before_the_opening_is_dropped);
    RUN_TEST(test_full_line_drops_whole_frames);
    RUN_TEST(test_line_that_vanishes_is_found_again);
    RUN_TEST(test_user_waits_for_nothing_while_another_thread_recovers);
    RUN_TEST(test_bus_may_be_closed_at_any_stage_of_its_recovery);
    RUN_TEST(test_two_threads_share_the_recovery);
    RUN_TEST(test_wrong_options_are_one_line);
    RUN_TEST(test_line_in_use_is_refused);
    RUN_TEST(test_frame_that_is_none_is_dropped);
    return UNITY_END();
}
