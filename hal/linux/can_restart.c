#include "can_restart.h"

#include <errno.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <string.h>
#include <sys/socket.h>

#define ANSWERS_AT_MOST 8

int can_restart_open(void) {
    return socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE);
}

/// Appends an attribute; length is the message's so far.
static size_t put(uint8_t *out, size_t length, uint16_t type, const void *value, size_t bytes) {
    const struct rtattr header = {.rta_len = (uint16_t)RTA_LENGTH(bytes), .rta_type = type};
    memcpy(&out[length], &header, sizeof header);
    if (bytes > 0) {
        memcpy(&out[length + RTA_LENGTH(0)], value, bytes);
    }
    return length + RTA_SPACE(bytes);
}

/// Makes the attribute at `start` end where the message ends.
static void end_nest(uint8_t *out, size_t start, size_t length) {
    const uint16_t bytes = (uint16_t)(length - start);
    memcpy(&out[start + offsetof(struct rtattr, rta_len)], &bytes, sizeof bytes);
}

size_t can_restart_request(uint8_t out[CAN_RESTART_BYTES], int interface_index, uint32_t sequence) {
    const uint32_t restart = 1;
    const struct ifinfomsg link = {.ifi_family = AF_UNSPEC, .ifi_index = interface_index};
    memset(out, 0, CAN_RESTART_BYTES);
    memcpy(&out[NLMSG_HDRLEN], &link, sizeof link);
    const size_t info = NLMSG_SPACE(sizeof link);
    size_t length = put(out, info, IFLA_LINKINFO, NULL, 0);
    length = put(out, length, IFLA_INFO_KIND, "can", strlen("can"));
    const size_t data = length;
    length = put(out, length, IFLA_INFO_DATA, NULL, 0);
    length = put(out, length, IFLA_CAN_RESTART, &restart, sizeof restart);
    end_nest(out, data, length);
    end_nest(out, info, length);
    const struct nlmsghdr header = {
        .nlmsg_len = (uint32_t)length,
        .nlmsg_type = RTM_NEWLINK,
        .nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK,
        .nlmsg_seq = sequence,
    };
    memcpy(out, &header, sizeof header);
    return length;
}

int can_restart_answer(const uint8_t *bytes, size_t length, uint32_t sequence) {
    struct nlmsghdr header;
    struct nlmsgerr answer;
    if (length < NLMSG_SPACE(sizeof answer.error)) {
        return -1;
    }
    memcpy(&header, bytes, sizeof header);
    if (header.nlmsg_type != NLMSG_ERROR || header.nlmsg_seq != sequence) {
        return -1;
    }
    memcpy(&answer.error, &bytes[NLMSG_HDRLEN], sizeof answer.error);
    return answer.error > 0 ? -1 : -answer.error;
}

// The kernel has dealt with the request when send returns: its answer is there.
int can_restart(int socket_fd, int interface_index, uint32_t sequence) {
    uint8_t bytes[512];
    const size_t length = can_restart_request(bytes, interface_index, sequence);
    if (send(socket_fd, bytes, length, 0) < 0) {
        return errno;
    }
    for (int i = 0; i < ANSWERS_AT_MOST; i++) {
        const ssize_t got = recv(socket_fd, bytes, sizeof bytes, 0);
        if (got < 0) {
            return errno;
        }
        const int answer = can_restart_answer(bytes, (size_t)got, sequence);
        if (answer >= 0) {
            return answer;
        }
    }
    return EPROTO;
}
