// SocketCAN as far as a machine without kernel CAN goes: options, error frames, the restart request
// and the kernel's real answer to it. Frames are exchanged in the virtual machine.
#include "can_bus.h"
#include "can_error.h"
#include "can_restart.h"
#include "one_line.h"
#include "unity.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

static linux_error_t error;

void setUp(void) {
    error.text[0] = '\0';
}

void tearDown(void) {}

static void assert_refused(const can_bus_options_t *options, const char *part) {
    TEST_ASSERT_NULL(can_bus_open(options, &error));
    assert_one_line(&error, part);
}

static void test_wrong_options_are_one_line(void) {
    static const uint32_t ids[CAN_BUS_MAX_IDS + 1u] = {0};
    static const uint32_t extended[] = {0x10, 0x800};
    assert_refused(&(can_bus_options_t){.interface = NULL}, "give one as can0");
    assert_refused(&(can_bus_options_t){.interface = ""}, "give one as can0");
    assert_refused(&(can_bus_options_t){.interface = "a-name-of-16-byt"}, "more than 15");
    assert_refused(
        &(can_bus_options_t){.interface = "can0", .ids = ids, .id_count = CAN_BUS_MAX_IDS + 1u},
        "33 ids");
    assert_refused(&(can_bus_options_t){.interface = "can0", .ids = extended, .id_count = 2},
                   "id 0x800");
}

static void test_interface_that_is_not_there_is_one_line(void) {
    const int fd = socket(PF_CAN, SOCK_RAW, 1);
    const bool has_can = fd >= 0;
    if (has_can) {
        (void)close(fd);
    }
    const char *const part = has_can ? "no such CAN interface" : "this kernel has no CAN sockets";
    assert_refused(&(can_bus_options_t){.interface = "can4000"}, part);
    assert_refused(&(can_bus_options_t){.interface = "lo"}, part);
}

static void test_closing_nothing_is_allowed(void) {
    can_bus_close(NULL);
}

static void test_error_frames_tell_the_state(void) {
    static const struct {
        can_bus_state_t before;
        uint32_t id;
        uint8_t controller;
        can_bus_state_t after;
    } cases[] = {
        {CAN_BUS_UP, CAN_ERR_BUSOFF, 0, CAN_BUS_OFF},
        {CAN_BUS_PASSIVE, CAN_ERR_BUSOFF | CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, CAN_BUS_OFF},
        {CAN_BUS_UP, CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE, CAN_BUS_PASSIVE},
        {CAN_BUS_UP, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, CAN_BUS_PASSIVE},
        {CAN_BUS_UP, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, CAN_BUS_UP},
        {CAN_BUS_PASSIVE, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, CAN_BUS_UP},
        {CAN_BUS_PASSIVE, CAN_ERR_CRTL, 0x40, CAN_BUS_UP},
        {CAN_BUS_PASSIVE, CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, CAN_BUS_PASSIVE},
        {CAN_BUS_OFF, CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, CAN_BUS_OFF},
        {CAN_BUS_OFF, CAN_ERR_RESTARTED, 0, CAN_BUS_UP},
        {CAN_BUS_OFF, CAN_ERR_ACK, 0, CAN_BUS_OFF},
        {CAN_BUS_UP, CAN_ERR_ACK | CAN_ERR_PROT | CAN_ERR_LOSTARB, 0xFF, CAN_BUS_UP},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        TEST_ASSERT_EQUAL(
            cases[i].after,
            can_error_state(cases[i].before, CAN_ERR_FLAG | cases[i].id, cases[i].controller));
    }
}

static const struct rtattr *find(const uint8_t *from, const uint8_t *to, uint16_t type) {
    while ((size_t)(to - from) >= sizeof(struct rtattr)) {
        const struct rtattr *const at = (const struct rtattr *)(const void *)from;
        TEST_ASSERT_TRUE(at->rta_len >= sizeof *at && at->rta_len <= to - from);
        if (at->rta_type == type) {
            return at;
        }
        from += RTA_ALIGN(at->rta_len);
    }
    return NULL;
}

static const uint8_t *inside(const struct rtattr *at) {
    return (const uint8_t *)at + RTA_LENGTH(0);
}

static const uint8_t *behind(const struct rtattr *at) {
    return (const uint8_t *)at + at->rta_len;
}

static void test_restart_request_is_what_ip_link_sends(void) {
    _Alignas(8) uint8_t bytes[CAN_RESTART_BYTES];
    const size_t length = can_restart_request(bytes, 5, 77);
    const struct nlmsghdr *const header = (const struct nlmsghdr *)(const void *)bytes;
    const struct ifinfomsg *const link = NLMSG_DATA(header);
    TEST_ASSERT_TRUE(length <= sizeof bytes);
    TEST_ASSERT_EQUAL_UINT32(length, header->nlmsg_len);
    TEST_ASSERT_EQUAL_UINT32(RTM_NEWLINK, header->nlmsg_type);
    TEST_ASSERT_EQUAL_UINT32(NLM_F_REQUEST | NLM_F_ACK, header->nlmsg_flags);
    TEST_ASSERT_EQUAL_UINT32(77, header->nlmsg_seq);
    TEST_ASSERT_EQUAL_INT(5, link->ifi_index);
    const uint8_t *const first = &bytes[NLMSG_SPACE(sizeof *link)];
    const struct rtattr *const info = find(first, &bytes[length], IFLA_LINKINFO);
    TEST_ASSERT_NOT_NULL(info);
    TEST_ASSERT_EQUAL_PTR(&bytes[length], behind(info));
    const struct rtattr *const kind = find(inside(info), behind(info), IFLA_INFO_KIND);
    TEST_ASSERT_NOT_NULL(kind);
    TEST_ASSERT_EQUAL_INT(0, memcmp(inside(kind), "can", 3));
    const struct rtattr *const data = find(inside(info), behind(info), IFLA_INFO_DATA);
    TEST_ASSERT_NOT_NULL(data);
    const struct rtattr *const restart = find(inside(data), behind(data), IFLA_CAN_RESTART);
    TEST_ASSERT_NOT_NULL(restart);
    TEST_ASSERT_EQUAL_UINT32(RTA_LENGTH(4), restart->rta_len);
    uint32_t value;
    memcpy(&value, inside(restart), sizeof value);
    TEST_ASSERT_EQUAL_UINT32(1, value);
}

static void test_answers_are_read_and_others_are_not(void) {
    struct {
        struct nlmsghdr header;
        struct nlmsgerr body;
    } answer = {.header = {.nlmsg_type = NLMSG_ERROR, .nlmsg_seq = 9}};
    const uint8_t *const bytes = (const uint8_t *)&answer;
    TEST_ASSERT_EQUAL_INT(0, can_restart_answer(bytes, sizeof answer, 9));
    answer.body.error = -EBUSY;
    TEST_ASSERT_EQUAL_INT(EBUSY, can_restart_answer(bytes, sizeof answer, 9));
    TEST_ASSERT_EQUAL_INT(-1, can_restart_answer(bytes, sizeof answer, 10));
    answer.body.error = 5;
    TEST_ASSERT_EQUAL_INT(-1, can_restart_answer(bytes, sizeof answer, 9));
    answer.header.nlmsg_type = NLMSG_DONE;
    TEST_ASSERT_EQUAL_INT(-1, can_restart_answer(bytes, sizeof answer, 9));
    for (size_t length = 0; length < 20u; length++) {
        TEST_ASSERT_EQUAL_INT(-1, can_restart_answer(bytes, length, 9));
    }
}

static void test_kernel_answers_a_restart_of_what_is_no_can_interface(void) {
    const int fd = can_restart_open();
    TEST_ASSERT_TRUE(fd >= 0);
    const int loopback = can_restart(fd, (int)if_nametoindex("lo"), 1);
    const int none = can_restart(fd, 1 << 20, 2);
    (void)close(fd);
    TEST_ASSERT_TRUE(loopback == EOPNOTSUPP || loopback == EPERM || loopback == EINVAL);
    TEST_ASSERT_TRUE(none == ENODEV || none == EPERM || none == EOPNOTSUPP);
    TEST_ASSERT_EQUAL_INT(EBADF, can_restart(-1, 1, 3));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_wrong_options_are_one_line);
    RUN_TEST(test_interface_that_is_not_there_is_one_line);
    RUN_TEST(test_closing_nothing_is_allowed);
    RUN_TEST(test_error_frames_tell_the_state);
    RUN_TEST(test_restart_request_is_what_ip_link_sends);
    RUN_TEST(test_answers_are_read_and_others_are_not);
    RUN_TEST(test_kernel_answers_a_restart_of_what_is_no_can_interface);
    return UNITY_END();
}
