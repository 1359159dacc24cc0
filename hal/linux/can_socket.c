// SocketCAN: Documentation/networking/can.rst.
#include "can_backends.h"
#include "can_common.h"
#include "can_error.h"
#include "can_restart.h"
#include "tick_linux.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define ERROR_FRAMES_AT_ONCE 32
/// A time stamp that differs more from now means that the wall clock was set meanwhile.
#define OLDEST_NS INT64_C(10000000000)
#define CONTROLLER_BYTE 1

typedef struct {
    can_bus_t bus; ///< first
    // What never changes
    char name[IFNAMSIZ];
    bool use_fd;
    bool has_filters;
    uint32_t filter_count;
    struct can_filter filters[CAN_BUS_MAX_IDS];
    int route_fd;
    // The user's
    uint32_t kernel_drops; ///< SO_RXQ_OVFL's last count of this socket
    // Recovery's
    int interface_index;
    uint32_t sequence; ///< of restart requests
} can_socket_t;

static int64_t to_ns(const struct timespec *time) {
    return (int64_t)time->tv_sec * 1000000000 + time->tv_nsec;
}

/// The kernel stamps with the wall clock; what it stamped is a moment old.
static int64_t to_monotonic_ns(int64_t wall_ns) {
    struct timespec wall;
    (void)clock_gettime(CLOCK_REALTIME, &wall);
    const int64_t age_ns = to_ns(&wall) - wall_ns;
    const int64_t now_ns = tick_linux_now_ns();
    return age_ns >= 0 && age_ns < OLDEST_NS ? now_ns - age_ns : now_ns;
}

static bool set(int fd, int level, int option, const void *value, size_t bytes) {
    return setsockopt(fd, level, option, value, (socklen_t)bytes) == 0;
}

static bool set_options(const can_socket_t *self, int fd) {
    const int on = 1;
    const int off = 0;
    const can_err_mask_t errors = CAN_ERR_MASK;
    return set(fd, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, &off, sizeof off) &&
           set(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) &&
           set(fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) &&
           set(fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) &&
           (!self->use_fd || set(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on)) &&
           (!self->has_filters || set(fd, SOL_CAN_RAW, CAN_RAW_FILTER, self->filters,
                                      self->filter_count * sizeof self->filters[0]));
}

static bool ask(const can_socket_t *self, int fd, unsigned long what, struct ifreq *answer) {
    memset(answer, 0, sizeof *answer);
    memcpy(answer->ifr_name, self->name, sizeof self->name);
    return ioctl(fd, what, answer) == 0;
}

static bool is_up(const can_socket_t *self, int fd) {
    struct ifreq answer;
    return ask(self, fd, SIOCGIFFLAGS, &answer) && (answer.ifr_flags & IFF_UP) != 0;
}

/// A socket bound to the interface. Returns 0, or an errno.
static int open_socket(can_socket_t *self, int *socket_fd) {
    struct ifreq answer;
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
    if (fd < 0) {
        return errno;
    }
    if (ask(self, fd, SIOCGIFINDEX, &answer) && set_options(self, fd)) {
        const struct sockaddr_can address = {.can_family = AF_CAN,
                                             .can_ifindex = answer.ifr_ifindex};
        if (bind(fd, (const struct sockaddr *)&address, sizeof address) == 0) {
            self->interface_index = answer.ifr_ifindex;
            *socket_fd = fd;
            return 0;
        }
    }
    const int number = errno;
    (void)close(fd);
    return number;
}

/// An error of a call on the socket.
static void take_errno(can_socket_t *self, int number) {
    switch (number) {
    case ENETDOWN:
        can_common_went_down(&self->bus, "interface is down");
        break;
    case ENODEV:
    case ENXIO:
        can_common_vanished(&self->bus, "interface is gone");
        break;
    default: // nothing to read, or no room to send: counted by the caller
        break;
    }
}

static void take_error_frame(can_socket_t *self, const struct canfd_frame *frame) {
    can_bus_t *const bus = &self->bus;
    const can_bus_state_t before = bus->state;
    can_common_count(&bus->counters.error_frames, 1);
    if ((frame->can_id & CAN_ERR_CRTL) != 0u &&
        (frame->data[CONTROLLER_BYTE] & CAN_ERR_CRTL_RX_OVERFLOW) != 0) {
        can_common_count(&bus->counters.overruns, 1);
        can_common_note(bus, "controller: %u frames lost, nobody took them in time (overrun)",
                        (unsigned int)bus->counters.overruns);
    }
    bus->state = can_error_state(before, frame->can_id, frame->data[CONTROLLER_BYTE]);
    if (bus->state == before) {
        return;
    }
    if (bus->state == CAN_BUS_OFF) {
        can_common_count(&bus->counters.bus_off, 1);
        bus->retry_ns = tick_linux_now_ns() + bus->restart_ns;
        can_common_note(bus, "bus-off");
    } else {
        can_common_note(bus, bus->state == CAN_BUS_PASSIVE ? "error passive" : "error active");
    }
}

/// The kernel's words beside a frame. Returns the frame's time.
static int64_t take_control(can_socket_t *self, struct msghdr *message) {
    int64_t time_ns = 0;
    for (struct cmsghdr *item = CMSG_FIRSTHDR(message); item != NULL;
         item = CMSG_NXTHDR(message, item)) {
        if (item->cmsg_level == SOL_SOCKET && item->cmsg_type == SCM_TIMESTAMPNS) {
            struct timespec stamp;
            memcpy(&stamp, CMSG_DATA(item), sizeof stamp);
            time_ns = to_monotonic_ns(to_ns(&stamp));
        } else if (item->cmsg_level == SOL_SOCKET && item->cmsg_type == SO_RXQ_OVFL) {
            uint32_t drops;
            memcpy(&drops, CMSG_DATA(item), sizeof drops);
            can_common_count(&self->bus.counters.rx_dropped, drops - self->kernel_drops);
            self->kernel_drops = drops;
        }
    }
    return time_ns != 0 ? time_ns : tick_linux_now_ns();
}

/// Returns the number of bytes, 0 where there is nothing.
static size_t read_frame(can_socket_t *self, struct canfd_frame *frame, int64_t *time_ns) {
    union { // aligned for the headers
        char bytes[CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t))];
        struct cmsghdr header;
    } control;
    struct iovec part = {.iov_base = frame, .iov_len = sizeof *frame};
    struct msghdr message = {.msg_iov = &part,
                             .msg_iovlen = 1,
                             .msg_control = control.bytes,
                             .msg_controllen = sizeof control.bytes};
    const ssize_t bytes = recvmsg(self->bus.fd, &message, 0);
    if (bytes < 0) {
        take_errno(self, errno);
        return 0;
    }
    *time_ns = take_control(self, &message);
    return (size_t)bytes;
}

static bool convert(const struct canfd_frame *in, size_t bytes, can_frame_t *out) {
    const bool is_known = bytes == CAN_MTU || bytes == CANFD_MTU;
    if (!is_known || in->len > CAN_MAX_BYTES) {
        return false;
    }
    const bool is_extended = (in->can_id & CAN_EFF_FLAG) != 0u;
    *out = (can_frame_t){
        .id = in->can_id & (is_extended ? CAN_EFF_MASK : CAN_SFF_MASK),
        .length = in->len,
        .is_extended = is_extended,
        .is_remote = (in->can_id & CAN_RTR_FLAG) != 0u,
    };
    if (!out->is_remote) {
        memcpy(out->data, in->data, in->len);
    }
    return true;
}

static bool receive(can_bus_t *bus, can_frame_t *frame, int64_t *time_ns) {
    can_socket_t *const self = (can_socket_t *)bus;
    for (int i = 0; i < ERROR_FRAMES_AT_ONCE && bus->fd >= 0; i++) {
        struct canfd_frame wire;
        const size_t bytes = read_frame(self, &wire, time_ns);
        if (bytes == 0) {
            return false;
        }
        if ((wire.can_id & CAN_ERR_FLAG) != 0u) {
            take_error_frame(self, &wire);
        } else if (convert(&wire, bytes, frame)) {
            return true;
        } else {
            can_common_count(&bus->counters.malformed, 1);
        }
    }
    return false;
}

static bool send_frame(can_bus_t *bus, const can_frame_t *frame) {
    can_socket_t *const self = (can_socket_t *)bus;
    struct canfd_frame wire = {
        .can_id = frame->id | (frame->is_extended ? CAN_EFF_FLAG : 0u) |
                  (frame->is_remote ? CAN_RTR_FLAG : 0u),
        .len = frame->length,
    };
    if (frame->length > CAN_MAX_BYTES) {
        return false;
    }
    memcpy(wire.data, frame->data, frame->length);
    const bool is_fd = self->use_fd && !frame->is_remote; // CAN FD has no remote frames
    wire.flags = is_fd ? CANFD_BRS : 0;
    const size_t bytes = is_fd ? CANFD_MTU : CAN_MTU;
    if (send(bus->fd, &wire, bytes, 0) == (ssize_t)bytes) {
        return true;
    }
    take_errno(self, errno);
    return false;
}

/// The kernel's answer to the restart request, which is repeated until the controller says that it
/// is up. Where it has said so meanwhile, the answer is no news.
static void adopt_answer(can_bus_t *bus) {
    const int answer = bus->recovery.answer;
    can_common_count(&bus->counters.restarts, 1);
    if (bus->state != CAN_BUS_OFF) {
        return;
    }
    switch (answer) {
    case 0:
        can_common_note(bus, "bus-off: restart asked for");
        break;
    case EBUSY:
        bus->state = CAN_BUS_UP;
        can_common_note(bus, "no longer bus-off");
        break;
    case EINVAL:
        can_common_note(bus, "bus-off: the driver restarts by itself (restart-ms is set)");
        break;
    case EPERM:
        can_common_note(bus, "bus-off: no right to restart (needs CAP_NET_ADMIN)");
        break;
    default:
        can_common_note(bus, "bus-off: restart refused: %s", strerror(answer));
        break;
    }
}

/// Looks for the interface: up again, gone, or another one of the same name.
static void look(can_socket_t *self) {
    can_recovery_t *const recovery = &self->bus.recovery;
    struct ifreq answer;
    if (recovery->fd >= 0 && (!ask(self, recovery->fd, SIOCGIFINDEX, &answer) ||
                              answer.ifr_ifindex != self->interface_index)) {
        (void)close(recovery->fd);
        recovery->fd = -1;
    }
    if (recovery->fd < 0) {
        recovery->is_new = open_socket(self, &recovery->fd) == 0;
    }
    recovery->is_up = recovery->fd >= 0 && is_up(self, recovery->fd);
}

static void recover(can_bus_t *bus) {
    can_socket_t *const self = (can_socket_t *)bus;
    if (bus->recovery.reason == CAN_BUS_OFF) {
        self->sequence++;
        bus->recovery.answer = can_restart(self->route_fd, self->interface_index, self->sequence);
    } else {
        look(self);
    }
}

static void adopt(can_bus_t *bus) {
    can_socket_t *const self = (can_socket_t *)bus;
    if (bus->recovery.reason == CAN_BUS_OFF) {
        adopt_answer(bus);
        return;
    }
    if (bus->fd < 0 || bus->recovery.is_new) {
        can_common_note(bus, "interface is gone");
    }
    if (bus->recovery.is_new) {
        self->kernel_drops = 0;
    }
    if (bus->recovery.is_up) {
        bus->state = CAN_BUS_UP;
        can_common_note(bus, "interface is up");
    }
}

static void close_socket(can_bus_t *bus) {
    can_socket_t *const self = (can_socket_t *)bus;
    can_common_close_files(bus);
    if (self->route_fd >= 0) {
        (void)close(self->route_fd);
    }
    free(self);
}

static const can_backend_t backend = {receive, send_frame, recover, adopt, NULL, close_socket};

static bool refuse(const char *name, int number, linux_error_t *error) {
    switch (number) {
    case EAFNOSUPPORT:
    case EPROTONOSUPPORT:
        return linux_fail(
            error,
            "CAN interface '%s': this kernel has no CAN sockets (modprobe can-raw), or "
            "give a serial adapter as slcan:/dev/ttyACM0",
            name);
    case ENODEV:
    case ENXIO:
        return linux_fail(error,
                          "CAN interface '%s': there is no such CAN interface "
                          "(ip link show type can lists them)",
                          name);
    default:
        return linux_fail(error, "CAN interface '%s': %s", name, strerror(number));
    }
}

static bool check_fd(const can_socket_t *self, linux_error_t *error) {
    struct ifreq answer;
    if (!self->use_fd ||
        (ask(self, self->bus.fd, SIOCGIFMTU, &answer) && answer.ifr_mtu >= (int)CANFD_MTU)) {
        return true;
    }
    return linux_fail(error,
                      "CAN interface '%s': CAN FD is not switched on "
                      "(ip link set %s type can ... fd on)",
                      self->name, self->name);
}

static void set_filters(can_socket_t *self, const can_bus_options_t *options) {
    self->has_filters = options->ids != NULL;
    self->filter_count = options->ids != NULL ? options->id_count : 0u;
    for (uint32_t i = 0; i < self->filter_count; i++) {
        self->filters[i] = (struct can_filter){
            .can_id = options->ids[i],
            .can_mask = CAN_SFF_MASK | CAN_EFF_FLAG | CAN_RTR_FLAG,
        };
    }
}

can_bus_t *can_socket_open(const can_bus_options_t *options, linux_error_t *error) {
    const uint32_t restart_ms =
        options->restart_ms != 0u ? options->restart_ms : CAN_RESTART_DEFAULT_MS;
    if (strlen(options->interface) >= IFNAMSIZ) {
        (void)linux_fail(error, "CAN interface '%.40s': the name has more than %d characters",
                         options->interface, IFNAMSIZ - 1);
        return NULL;
    }
    can_socket_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    can_common_init(&self->bus, &backend);
    memcpy(self->name, options->interface, strlen(options->interface));
    self->use_fd = options->use_fd;
    self->bus.restart_ns = (int64_t)restart_ms * 1000000;
    self->route_fd = can_restart_open();
    set_filters(self, options);
    const int number = open_socket(self, &self->bus.fd);
    if (number != 0 ? !refuse(self->name, number, error) : !check_fd(self, error)) {
        close_socket(&self->bus);
        return NULL;
    }
    self->bus.state = is_up(self, self->bus.fd) ? CAN_BUS_UP : CAN_BUS_DOWN;
    return &self->bus;
}
