#include "guest_bus.h"

#include "quiesce_can.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { MAX_IDS = 8 };

static int64_t clock_ns(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void set_filters(int bus, const uint32_t *ids, uint32_t id_count) {
    struct can_filter filters[MAX_IDS];
    for (uint32_t i = 0; i < id_count; i++) {
        filters[i].can_id = ids[i];
        filters[i].can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG;
    }
    if (setsockopt(bus, SOL_CAN_RAW, CAN_RAW_FILTER, filters,
                   (socklen_t)(id_count * sizeof filters[0])) != 0) {
        guest_fail("filter");
    }
}

int guest_bus_open(const char *interface, const uint32_t *ids, uint32_t id_count) {
    const int bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    const unsigned index = if_nametoindex(interface);
    if (bus < 0 || index == 0 || id_count > MAX_IDS) {
        guest_fail(interface);
    }
    set_filters(bus, ids, id_count);
    const int on = 1;
    if (setsockopt(bus, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0) {
        guest_fail("time stamps");
    }
    struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = (int)index};
    if (bind(bus, (const struct sockaddr *)&address, sizeof address) != 0) {
        guest_fail("bind");
    }
    return bus;
}

static int64_t time_stamp_ns(struct msghdr *message) {
    for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c != NULL; c = CMSG_NXTHDR(message, c)) {
        if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_TIMESTAMPNS) {
            struct timespec stamp;
            memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
            const int64_t real_ns = (int64_t)stamp.tv_sec * 1000000000 + stamp.tv_nsec;
            return real_ns + clock_ns(CLOCK_MONOTONIC) - clock_ns(CLOCK_REALTIME);
        }
    }
    guest_fail("a frame without a time stamp");
}

bool guest_bus_receive(int bus, guest_frame_t *received) {
    struct can_frame raw;
    char control[256];
    struct iovec data = {.iov_base = &raw, .iov_len = sizeof raw};
    struct msghdr message = {.msg_iov = &data,
                             .msg_iovlen = 1,
                             .msg_control = control,
                             .msg_controllen = sizeof control};
    ssize_t bytes = -1;
    do {
        bytes = recvmsg(bus, &message, 0);
    } while (bytes < 0 && errno == EINTR);
    if (bytes < 0 && errno == ENETDOWN) {
        return false;
    }
    if (bytes != (ssize_t)sizeof raw) {
        guest_fail("receive");
    }
    memset(received, 0, sizeof *received);
    received->frame.id = raw.can_id & CAN_SFF_MASK;
    received->frame.length = raw.can_dlc;
    memcpy(received->frame.data, raw.data, sizeof raw.data);
    received->time_ns = time_stamp_ns(&message);
    return true;
}

bool guest_bus_send(int bus, const can_frame_t *frame) {
    struct can_frame raw;
    memset(&raw, 0, sizeof raw);
    raw.can_id =
        frame->id | (frame->is_extended ? CAN_EFF_FLAG : 0) | (frame->is_remote ? CAN_RTR_FLAG : 0);
    raw.can_dlc = frame->length;
    memcpy(raw.data, frame->data, sizeof raw.data);
    while (write(bus, &raw, sizeof raw) != (ssize_t)sizeof raw) {
        if (errno == ENETDOWN) {
            return false;
        }
        if (errno != ENOBUFS && errno != EINTR) {
            guest_fail("send");
        }
        // The interface's own queue: poll() does not see it.
        sched_yield();
    }
    return true;
}

// An enable that was held before these ended arms nothing.
static bool wants_release(uint8_t state) {
    return state == QUIESCE_CAN_CURRENT_DEMAND_STATE_INIT_CHOICE ||
           state == QUIESCE_CAN_CURRENT_DEMAND_STATE_SELF_TEST_CHOICE ||
           state == QUIESCE_CAN_CURRENT_DEMAND_STATE_FAULT_CHOICE;
}

bool guest_is_demand(const can_frame_t *frame) {
    return e2e_check(&quiesce_can_messages[QUIESCE_CAN_AT_CURRENT_DEMAND].e2e, frame) == E2E_OK;
}

guest_demand_t guest_demand(const can_frame_t *frame) {
    struct quiesce_can_current_demand_t demand;
    quiesce_can_current_demand_unpack(&demand, frame->data, frame->length);
    return (guest_demand_t){.current_mA = demand.current_cmd_mA,
                            .is_enabled = demand.driver_is_enabled != 0,
                            .wants_release = wants_release(demand.state)};
}

enum { LET_GO_COMMANDS = 4 }; /* the third of a sender is the first that counts */

void guest_hand_see(guest_hand_t *hand, const guest_demand_t *demand) {
    hand->left = demand->wants_release ? LET_GO_COMMANDS : hand->left;
}

bool guest_hand_enables(guest_hand_t *hand) {
    const bool enables = hand->left == 0;
    hand->left -= enables ? 0 : 1;
    return enables;
}

void guest_protect(can_frame_t *frame, uint32_t message, uint8_t *alive) {
    frame->id = quiesce_can_messages[message].e2e.id;
    frame->length = quiesce_can_messages[message].e2e.length;
    e2e_protect(&quiesce_can_messages[message].e2e, alive, frame);
}

void guest_sample(can_frame_t *frame, int32_t accel_counts, uint8_t *alive) {
    struct quiesce_can_accel_sample_t sample = {.accel_counts = accel_counts};
    memset(frame, 0, sizeof *frame);
    quiesce_can_accel_sample_pack(frame->data, &sample, sizeof frame->data);
    guest_protect(frame, QUIESCE_CAN_AT_ACCEL_SAMPLE, alive);
}

void guest_command(can_frame_t *frame, bool enable, bool fault_reset, uint8_t *alive) {
    struct quiesce_can_operator_command_t command = {.enable = enable, .fault_reset = fault_reset};
    memset(frame, 0, sizeof *frame);
    quiesce_can_operator_command_pack(frame->data, &command, sizeof frame->data);
    guest_protect(frame, QUIESCE_CAN_AT_OPERATOR_COMMAND, alive);
}

int64_t guest_now_ns(void) {
    return clock_ns(CLOCK_MONOTONIC);
}

void guest_sleep_until(int64_t time_ns) {
    const struct timespec until = {.tv_sec = time_ns / 1000000000, .tv_nsec = time_ns % 1000000000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR) {
    }
}

void guest_real_time(int priority) {
    const struct sched_param param = {.sched_priority = priority};
    if (sched_setscheduler(0, SCHED_FIFO, &param) != 0) {
        guest_fail("SCHED_FIFO");
    }
}

void guest_fail(const char *what) {
    fprintf(stderr, "%s: %s: %s\n", program_invocation_short_name, what, strerror(errno));
    exit(1);
}

int32_t guest_number(const char *text, int32_t low, int32_t high) {
    char *end = NULL;
    errno = 0;
    const long value = strtol(text, &end, 10);
    if (errno != 0 || end == text || *end != '\0' || value < low || value > high) {
        fprintf(stderr, "%s: %s: expected a number from %d to %d\n", program_invocation_short_name,
                text, low, high);
        exit(2);
    }
    return (int32_t)value;
}
