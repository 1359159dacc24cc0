// SocketCAN on the kernel's virtual interfaces: in the virtual machine, and wherever root may make
// one. vcan hands a frame over before write() returns: nothing here waits.
#include "can_bus.h"
#include "tick_linux.h"
#include "unity.h"
#include "vcan.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define SECOND_NS INT64_C(1000000000)

static char name[16];
static bool is_made;
static int peer;
static can_bus_t *bus;
static int64_t now_ns; ///< of the calls of can_bus_repair
static linux_error_t error;

void setUp(void) {
    (void)snprintf(name, sizeof name, "qv%u", (unsigned int)getpid() % 1000000u);
    error.text[0] = '\0';
    bus = NULL;
    peer = -1;
    now_ns = tick_linux_now_ns();
    is_made = vcan_make(name);
    if (!is_made) {
        TEST_IGNORE_MESSAGE("no virtual CAN interfaces here, or no right to make one");
    }
}

void tearDown(void) {
    can_bus_close(bus);
    if (peer >= 0) {
        (void)close(peer);
    }
    if (is_made) {
        vcan_remove(name);
    }
}

static void join(void) {
    if (peer >= 0) {
        (void)close(peer); // it may hold the error of an interface that was down
    }
    peer = vcan_peer(name);
}

static void open_up(can_bus_options_t options) {
    options.interface = name;
    options.restart_ms = 20;
    vcan_set_up(name, true);
    bus = can_bus_open(&options, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(bus, error.text);
    TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
    join();
}

static void replace_interface(void) {
    vcan_remove(name);
    TEST_ASSERT_TRUE(vcan_make(name));
    vcan_set_up(name, true);
}

static void tell(uint32_t id, uint8_t second_byte) {
    const struct can_frame frame = {.can_id = id, .can_dlc = 8, .data = {1, second_byte}};
    TEST_ASSERT_EQUAL_INT(sizeof frame, write(peer, &frame, sizeof frame));
}

static void maintain_later(void) {
    now_ns += SECOND_NS;
    can_bus_repair(bus, now_ns);
}

static void assert_receives(uint32_t id) {
    can_frame_t frame = {0};
    tell(id, 9);
    TEST_ASSERT_TRUE(can_bus_receive(bus, &frame, NULL));
    TEST_ASSERT_EQUAL_HEX32(id, frame.id);
    TEST_ASSERT_EQUAL_UINT8(8, frame.length);
    TEST_ASSERT_EQUAL_UINT8(9, frame.data[1]);
}

static void assert_receives_nothing(void) {
    can_frame_t frame;
    TEST_ASSERT_FALSE(can_bus_receive(bus, &frame, NULL));
}

static void test_frames_go_both_ways_and_ours_do_not_come_back(void) {
    struct can_frame heard;
    open_up((can_bus_options_t){0});
    assert_receives(0x123);
    TEST_ASSERT_TRUE(can_bus_send(bus, &(can_frame_t){.id = 0x321, .length = 2, .data = {7, 8}}));
    assert_receives_nothing();
    TEST_ASSERT_EQUAL_INT(sizeof heard, read(peer, &heard, sizeof heard));
    TEST_ASSERT_EQUAL_HEX32(0x321, heard.can_id);
    TEST_ASSERT_EQUAL_UINT8(2, heard.can_dlc);
    TEST_ASSERT_EQUAL_UINT8(8, heard.data[1]);
    TEST_ASSERT_TRUE(can_bus_send(bus, &(can_frame_t){.id = 0x1ABCDEF0, .is_extended = true}));
    TEST_ASSERT_EQUAL_INT(sizeof heard, read(peer, &heard, sizeof heard));
    TEST_ASSERT_EQUAL_HEX32(0x1ABCDEF0 | CAN_EFF_FLAG, heard.can_id);
    TEST_ASSERT_TRUE(can_bus_send(bus, &(can_frame_t){.id = 1, .is_remote = true, .length = 4}));
    TEST_ASSERT_EQUAL_INT(sizeof heard, read(peer, &heard, sizeof heard));
    TEST_ASSERT_EQUAL_HEX32(1 | CAN_RTR_FLAG, heard.can_id);
    TEST_ASSERT_EQUAL_UINT32(1, can_bus_counters(bus)->received);
    TEST_ASSERT_EQUAL_UINT32(3, can_bus_counters(bus)->sent);
}

static void test_only_wanted_ids_arrive(void) {
    static const uint32_t ids[] = {0x10, 0x20};
    can_frame_t frame;
    open_up((can_bus_options_t){.ids = ids, .id_count = 2});
    tell(0x11, 0);
    tell(0x10 | CAN_EFF_FLAG, 0);
    tell(0x20 | CAN_RTR_FLAG, 0);
    tell(0x20, 0);
    TEST_ASSERT_TRUE(can_bus_receive(bus, &frame, NULL));
    TEST_ASSERT_EQUAL_HEX32(0x20, frame.id);
    TEST_ASSERT_FALSE(frame.is_remote);
    assert_receives_nothing();
}

static void test_time_is_that_of_the_kernel_not_of_the_read(void) {
    can_frame_t frame;
    int64_t time_ns = 0;
    int64_t second_ns = 0;
    open_up((can_bus_options_t){0});
    const int64_t before_ns = tick_linux_now_ns();
    tell(0x10, 0);
    const int64_t between_ns = tick_linux_now_ns();
    tell(0x10, 1);
    TEST_ASSERT_TRUE(can_bus_receive(bus, &frame, &time_ns));
    TEST_ASSERT_TRUE(can_bus_receive(bus, &frame, &second_ns));
    // The two clocks are read one after the other: a preemption in between may only make it later.
    TEST_ASSERT_TRUE(time_ns >= before_ns && second_ns >= between_ns);
    TEST_ASSERT_TRUE(second_ns <= tick_linux_now_ns());
}

static void test_error_frames_lead_to_the_restart_request(void) {
    open_up((can_bus_options_t){0});
    const int64_t off_ns = tick_linux_now_ns();
    tell(CAN_ERR_FLAG | CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    assert_receives_nothing();
    TEST_ASSERT_EQUAL(CAN_BUS_PASSIVE, can_bus_state(bus));
    tell(CAN_ERR_FLAG | CAN_ERR_BUSOFF, 0);
    assert_receives_nothing();
    TEST_ASSERT_EQUAL(CAN_BUS_OFF, can_bus_state(bus));
    TEST_ASSERT_EQUAL_STRING("bus-off", can_bus_last_event(bus)->text);
    can_bus_repair(bus, off_ns); // not before restart_ms
    TEST_ASSERT_EQUAL_UINT32(0, can_bus_counters(bus)->restarts);
    maintain_later();
    TEST_ASSERT_EQUAL_UINT32(1, can_bus_counters(bus)->restarts);
    // vcan has no controller: the kernel says so, and the request is repeated.
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(can_bus_last_event(bus)->text, "restart refused"),
                                 can_bus_last_event(bus)->text);
    const uint32_t changes = can_bus_last_event(bus)->number;
    maintain_later();
    TEST_ASSERT_EQUAL_UINT32(2, can_bus_counters(bus)->restarts);
    TEST_ASSERT_EQUAL_UINT32(changes, can_bus_last_event(bus)->number);
    tell(CAN_ERR_FLAG | CAN_ERR_RESTARTED, 0);
    assert_receives(0x10);
    TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
    TEST_ASSERT_EQUAL_UINT32(3, can_bus_counters(bus)->error_frames);
    TEST_ASSERT_EQUAL_UINT32(1, can_bus_counters(bus)->bus_off);
}

static void test_frames_that_the_kernel_dropped_are_counted(void) {
    const uint32_t frames = 5000;
    can_frame_t frame;
    uint32_t got = 0;
    open_up((can_bus_options_t){0});
    for (uint32_t round = 0; round < 2u; round++) {
        for (uint32_t i = 0; i < frames; i++) {
            tell(0x10, (uint8_t)i);
        }
        while (can_bus_receive(bus, &frame, NULL)) {
            got++;
        }
        tell(0x10, 0); // brings the count of the drops
        TEST_ASSERT_TRUE(can_bus_receive(bus, &frame, NULL));
        got++;
    }
    TEST_ASSERT_TRUE(can_bus_counters(bus)->rx_dropped > 0u);
    TEST_ASSERT_EQUAL_UINT32(2u * frames + 2u, got + can_bus_counters(bus)->rx_dropped);
}

static void test_interface_that_is_down_is_used_once_it_is_up(void) {
    bus = can_bus_open(&(can_bus_options_t){.interface = name}, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(bus, error.text);
    TEST_ASSERT_EQUAL(CAN_BUS_DOWN, can_bus_state(bus));
    assert_receives_nothing();
    TEST_ASSERT_FALSE(can_bus_send(bus, &(can_frame_t){.id = 1}));
    maintain_later();
    TEST_ASSERT_EQUAL(CAN_BUS_DOWN, can_bus_state(bus));
    TEST_ASSERT_EQUAL_UINT32(0, can_bus_counters(bus)->down); // it never was up
    for (uint32_t round = 1; round <= 3u; round++) {
        vcan_set_up(name, true);
        maintain_later();
        TEST_ASSERT_EQUAL(CAN_BUS_UP, can_bus_state(bus));
        join();
        assert_receives(0x10);
        vcan_set_up(name, false);
        assert_receives_nothing();
        TEST_ASSERT_EQUAL(CAN_BUS_DOWN, can_bus_state(bus));
        TEST_ASSERT_EQUAL_STRING("interface is down", can_bus_last_event(bus)->text);
        TEST_ASSERT_EQUAL_UINT32(round, can_bus_counters(bus)->down);
        TEST_ASSERT_FALSE(can_bus_send(bus, &(can_frame_t){.id = 1}));
    }
}

static void test_interface_that_vanishes_is_found_again(void) {
    static const uint32_t ids[] = {0x10, 0x20};
    open_up((can_bus_options_t){.ids = ids, .id_count = 2});
    vcan_remove(name);
    assert_receives_nothing();
    TEST_ASSERT_EQUAL_INT(-1, can_bus_fd(bus));
    TEST_ASSERT_EQUAL_STRING("interface is gone", can_bus_last_event(bus)->text);
    maintain_later();
    TEST_ASSERT_EQUAL(CAN_BUS_DOWN, can_bus_state(bus));
    TEST_ASSERT_TRUE(vcan_make(name));
    vcan_set_up(name, true);
    maintain_later();
    join();
    tell(0x99, 0); // the filters are there again
    assert_receives(0x20);
    TEST_ASSERT_EQUAL_UINT32(1, can_bus_counters(bus)->down);
}

static void test_other_interface_of_the_same_name_is_joined(void) {
    open_up((can_bus_options_t){0});
    replace_interface(); // while nobody looked
    assert_receives_nothing();
    maintain_later();
    join();
    assert_receives(0x10);
    vcan_set_up(name, false); // noticed as down only, then replaced
    assert_receives_nothing();
    replace_interface();
    maintain_later();
    join();
    assert_receives(0x20);
}

static void test_fd_frames_where_the_interface_has_them(void) {
    struct canfd_frame frame;
    can_frame_t received;
    vcan_set_mtu(name, (int)CANFD_MTU);
    open_up((can_bus_options_t){.use_fd = true});
    TEST_ASSERT_TRUE(can_bus_send(bus, &(can_frame_t){.id = 0x10, .length = 3}));
    TEST_ASSERT_EQUAL_INT(CANFD_MTU, read(peer, &frame, sizeof frame));
    TEST_ASSERT_EQUAL_UINT8(CANFD_BRS, frame.flags & CANFD_BRS);
    assert_receives(0x11); // a classic one
    frame = (struct canfd_frame){.can_id = 0x12, .len = 12};
    TEST_ASSERT_EQUAL_INT(CANFD_MTU, write(peer, &frame, CANFD_MTU));
    frame = (struct canfd_frame){.can_id = 0x13, .len = 5};
    TEST_ASSERT_EQUAL_INT(CANFD_MTU, write(peer, &frame, CANFD_MTU));
    TEST_ASSERT_TRUE(can_bus_receive(bus, &received, NULL));
    TEST_ASSERT_EQUAL_HEX32(0x13, received.id);
    TEST_ASSERT_EQUAL_UINT32(1, can_bus_counters(bus)->malformed);
}

static void test_fd_is_refused_where_the_interface_has_none(void) {
    vcan_set_mtu(name, (int)CAN_MTU);
    TEST_ASSERT_NULL(can_bus_open(&(can_bus_options_t){.interface = name, .use_fd = true}, &error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "CAN FD is not switched on"), error.text);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_frames_go_both_ways_and_ours_do_not_come_back);
    RUN_TEST(test_only_wanted_ids_arrive);
    RUN_TEST(test_time_is_that_of_the_kernel_not_of_the_read);
    RUN_TEST(test_error_frames_lead_to_the_restart_request);
    RUN_TEST(test_frames_that_the_kernel_dropped_are_counted);
    RUN_TEST(test_interface_that_is_down_is_used_once_it_is_up);
    RUN_TEST(test_interface_that_vanishes_is_found_again);
    RUN_TEST(test_other_interface_of_the_same_name_is_joined);
    RUN_TEST(test_fd_frames_where_the_interface_has_them);
    RUN_TEST(test_fd_is_refused_where_the_interface_has_none);
    return UNITY_END();
}
