#include "vcan.h"

#include "unity.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

typedef struct {
    struct nlmsghdr header;
    struct ifinfomsg link;
    uint8_t attributes[96];
} request_t;

static void add(request_t *request, uint16_t type, const void *value, size_t bytes) {
    const struct rtattr header = {.rta_len = (uint16_t)RTA_LENGTH(bytes), .rta_type = type};
    uint8_t *const at = (uint8_t *)request + request->header.nlmsg_len;
    memcpy(at, &header, sizeof header);
    memcpy(at + RTA_LENGTH(0), value, bytes);
    request->header.nlmsg_len += (uint32_t)RTA_SPACE(bytes);
}

/// Returns 0, or an errno.
static int ask(const request_t *request) {
    struct {
        struct nlmsghdr header;
        struct nlmsgerr error;
        uint8_t rest[256];
    } answer;
    const int fd = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (fd < 0) {
        return errno;
    }
    const bool is_sent = send(fd, request, request->header.nlmsg_len, 0) >= 0;
    const bool is_answered = is_sent && recv(fd, &answer, sizeof answer, 0) > 0;
    const int number = is_answered ? -answer.error.error : EIO;
    (void)close(fd);
    return number;
}

static request_t request_of(uint16_t type, uint16_t flags) {
    const request_t request = {
        .header = {.nlmsg_len = NLMSG_LENGTH(sizeof(struct ifinfomsg)),
                   .nlmsg_type = type,
                   .nlmsg_flags = (uint16_t)(NLM_F_REQUEST | NLM_F_ACK | flags)},
    };
    return request;
}

bool vcan_make(const char *name) {
    struct {
        struct rtattr header;
        char text[4];
    } const kind = {{.rta_len = sizeof kind, .rta_type = IFLA_INFO_KIND}, {'v', 'c', 'a', 'n'}};
    request_t request = request_of(RTM_NEWLINK, NLM_F_CREATE | NLM_F_EXCL);
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    if (fd < 0) {
        return false;
    }
    (void)close(fd);
    add(&request, IFLA_IFNAME, name, strlen(name) + 1u);
    add(&request, IFLA_LINKINFO, &kind, sizeof kind);
    return ask(&request) == 0;
}

void vcan_remove(const char *name) {
    request_t request = request_of(RTM_DELLINK, 0);
    request.link.ifi_index = (int)if_nametoindex(name);
    TEST_ASSERT_EQUAL_INT(0, ask(&request));
}

static void set(const char *name, unsigned long what, struct ifreq *request) {
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    TEST_ASSERT_TRUE(fd >= 0);
    memcpy(request->ifr_name, name, strlen(name) + 1u);
    TEST_ASSERT_EQUAL_INT(0, ioctl(fd, what, request));
    (void)close(fd);
}

void vcan_set_up(const char *name, bool is_up) {
    struct ifreq request = {.ifr_flags = (short)(is_up ? IFF_UP : 0)};
    set(name, SIOCSIFFLAGS, &request);
}

void vcan_set_mtu(const char *name, int mtu) {
    struct ifreq request = {.ifr_mtu = mtu};
    set(name, SIOCSIFMTU, &request);
}

int vcan_peer(const char *name) {
    const int on = 1;
    const struct sockaddr_can address = {.can_family = AF_CAN,
                                         .can_ifindex = (int)if_nametoindex(name)};
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
    TEST_ASSERT_TRUE(fd >= 0);
    TEST_ASSERT_EQUAL_INT(0, setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on));
    TEST_ASSERT_EQUAL_INT(0, bind(fd, (const struct sockaddr *)&address, sizeof address));
    return fd;
}
