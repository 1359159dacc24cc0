// SLCAN over a serial line: the adapter, a board's UART, or a pty.
#include "can_backends.h"
#include "can_common.h"
#include "slcan.h"
#include "tick_linux.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#define PATH_BYTES 108
/// Bytes taken at once; a call takes at most READS_AT_ONCE times as many, whatever they are.
#define READ_BYTES 512u
#define READS_AT_ONCE 4
#define BELL 0x07u // an adapter's refusal
#define IDS (CAN_MAX_STANDARD_ID + 1u)

typedef struct {
    can_bus_t bus; ///< first
    // What never changes
    char path[PATH_BYTES];
    speed_t speed;     ///< B0: leave it
    char commands[16]; ///< that open the adapter, or none
    bool takes_all;
    uint8_t wanted[IDS / 8u]; ///< a bit an id
    // The user's
    slcan_decoder_t decoder;
    uint32_t malformed_seen; ///< of the decoder's count
    uint8_t read[READ_BYTES];
    size_t read_at;
    size_t read_end;
    int64_t read_ns;
    uint8_t unsent[SLCAN_MAX_BYTES]; ///< rest of a line that was sent in part
    size_t unsent_bytes;
    bool has_overruns; ///< the kernel counts them; this many by the last look
    uint32_t overruns_seen;
} can_serial_t;

static bool is_temporary(int number) {
    return number == EAGAIN || number == EINTR;
}

static bool find_speed(uint32_t baud, speed_t *speed) {
    static const struct {
        uint32_t baud;
        speed_t speed;
    } speeds[] = {
        {0, B0},
        {9600, B9600},
        {19200, B19200},
        {38400, B38400},
        {57600, B57600},
        {115200, B115200},
        {230400, B230400},
        {460800, B460800},
        {500000, B500000},
        {576000, B576000},
        {921600, B921600},
        {1000000, B1000000},
        {1152000, B1152000},
        {1500000, B1500000},
        {2000000, B2000000},
        {2500000, B2500000},
        {3000000, B3000000},
        {3500000, B3500000},
        {4000000, B4000000},
    };
    for (size_t i = 0; i < sizeof speeds / sizeof speeds[0]; i++) {
        if (speeds[i].baud == baud) {
            *speed = speeds[i].speed;
            return true;
        }
    }
    return false;
}

/// The adapter's commands for a bit rate: close, set, open; none for 0.
static bool find_commands(uint32_t bitrate, char *commands, size_t bytes) {
    static const uint32_t rates[] = {10000,  20000,  50000,  100000, 125000,
                                     250000, 500000, 800000, 1000000};
    if (bitrate == 0u) {
        commands[0] = '\0';
        return true;
    }
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        if (rates[i] == bitrate) {
            (void)snprintf(commands, bytes, "C\rS%u\rO\r", (unsigned int)i);
            return true;
        }
    }
    return false;
}

/// Raw bytes, no waiting. Returns 0, or an errno.
static int set_line(const can_serial_t *self, int fd) {
    struct termios line;
    if (tcgetattr(fd, &line) != 0) {
        return errno;
    }
    cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD;
    if (self->speed != B0 && cfsetspeed(&line, self->speed) != 0) {
        return errno;
    }
    if (tcsetattr(fd, TCSANOW, &line) != 0 || tcflush(fd, TCIFLUSH) != 0) {
        return errno;
    }
    const size_t bytes = strlen(self->commands);
    if (bytes > 0 && write(fd, self->commands, bytes) != (ssize_t)bytes) {
        return EIO;
    }
    return 0;
}

/// Opens the line. Returns 0, or an errno.
static int open_line(const can_serial_t *self, int *line_fd) {
    const int fd = open(self->path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        return errno;
    }
    // As other programs for serial lines do: a second one would take half of the bytes.
    int number = flock(fd, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    if (number == 0) {
        number = set_line(self, fd);
    }
    if (number != 0) {
        (void)close(fd);
        return number;
    }
    *line_fd = fd;
    return 0;
}

/// A pty, and many an adapter, counts nothing.
static void look(can_bus_t *bus) {
    can_serial_t *const self = (can_serial_t *)bus;
    struct serial_icounter_struct counts;
    if (ioctl(bus->fd, TIOCGICOUNT, &counts) != 0) {
        return;
    }
    const uint32_t seen = (uint32_t)counts.overrun + (uint32_t)counts.buf_overrun;
    if (self->has_overruns && seen != self->overruns_seen) {
        can_common_count(&bus->counters.overruns, seen - self->overruns_seen);
        can_common_note(bus, "serial line: %u bytes lost, nobody took them in time (overrun)",
                        (unsigned int)bus->counters.overruns);
    }
    self->overruns_seen = seen;
    self->has_overruns = true;
}

/// The line in self->bus.fd is a new one.
static void begin(can_serial_t *self) {
    slcan_decoder_init(&self->decoder);
    self->malformed_seen = 0;
    self->read_at = 0;
    self->read_end = 0;
    self->unsent_bytes = 0;
    self->has_overruns = false;
    self->bus.state = CAN_BUS_UP;
    look(&self->bus); // what it has lost before is nobody's
}

static void vanish(can_serial_t *self) {
    can_common_vanished(&self->bus, "serial line is gone");
}

/// Fills the buffer. Returns false where nothing has arrived.
static bool read_more(can_serial_t *self) {
    const ssize_t bytes = read(self->bus.fd, self->read, sizeof self->read);
    if (bytes > 0) {
        self->read_at = 0;
        self->read_end = (size_t)bytes;
        self->read_ns = tick_linux_now_ns();
        return true;
    }
    if (bytes == 0 || !is_temporary(errno)) {
        vanish(self);
    }
    return false;
}

static bool is_wanted(const can_serial_t *self, const can_frame_t *frame) {
    return self->takes_all || (!frame->is_extended && !frame->is_remote &&
                               (self->wanted[frame->id / 8u] >> (frame->id % 8u) & 1u) != 0u);
}

/// Decodes up to the next frame that is wanted; false: the buffer is empty.
static bool decode(can_serial_t *self, can_frame_t *frame) {
    bool is_found = false;
    while (!is_found && self->read_at < self->read_end) {
        const uint8_t byte = self->read[self->read_at++];
        if (byte == BELL) { // ends a line as CR does
            can_common_count(&self->bus.counters.error_frames, 1);
        }
        can_frame_t decoded;
        if (slcan_decode(&self->decoder, byte == BELL ? (uint8_t)'\r' : byte, &decoded) &&
            is_wanted(self, &decoded)) {
            *frame = decoded;
            is_found = true;
        }
    }
    can_common_count(&self->bus.counters.malformed,
                     self->decoder.malformed_count - self->malformed_seen);
    self->malformed_seen = self->decoder.malformed_count;
    return is_found;
}

static bool receive(can_bus_t *bus, can_frame_t *frame, int64_t *time_ns) {
    can_serial_t *const self = (can_serial_t *)bus;
    for (int reads = 0; !decode(self, frame); reads++) {
        if (reads == READS_AT_ONCE || !read_more(self)) {
            return false;
        }
    }
    *time_ns = self->read_ns;
    return true;
}

/// Writes what it can and keeps the rest of the line. Returns false iff the line is gone.
static bool write_some(can_serial_t *self) {
    if (self->unsent_bytes == 0) {
        return true;
    }
    const ssize_t bytes = write(self->bus.fd, self->unsent, self->unsent_bytes);
    if (bytes < 0) {
        if (!is_temporary(errno)) {
            vanish(self);
            return false;
        }
        return true;
    }
    self->unsent_bytes -= (size_t)bytes;
    memmove(self->unsent, &self->unsent[bytes], self->unsent_bytes);
    return true;
}

// A line goes out as a whole or not at all, so that none is torn: its rest is sent first.
static bool send_frame(can_bus_t *bus, const can_frame_t *frame) {
    can_serial_t *const self = (can_serial_t *)bus;
    if (!write_some(self) || self->unsent_bytes > 0) {
        return false;
    }
    const size_t line_bytes = slcan_encode(frame, self->unsent);
    self->unsent_bytes = line_bytes;
    if (line_bytes == 0 || !write_some(self)) {
        return false;
    }
    if (self->unsent_bytes == line_bytes) { // not begun: forget it
        self->unsent_bytes = 0;
        return false;
    }
    return true;
}

static void recover(can_bus_t *bus) {
    bus->recovery.is_new = open_line((const can_serial_t *)bus, &bus->recovery.fd) == 0;
}

static void adopt(can_bus_t *bus) {
    if (bus->recovery.is_new) {
        begin((can_serial_t *)bus);
        can_common_note(bus, "serial line is back");
    }
}

static void close_serial(can_bus_t *bus) {
    can_serial_t *const self = (can_serial_t *)bus;
    if (bus->fd >= 0 && self->commands[0] != '\0' && write(bus->fd, "C\r", 2) != 2) {
        can_common_count(&bus->counters.tx_dropped, 1);
    }
    can_common_close_files(bus);
    free(self);
}

static const can_backend_t backend = {receive, send_frame, recover, adopt, look, close_serial};

static void refuse(const char *path, int number, linux_error_t *error) {
    switch (number) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
        (void)linux_fail(error, "CAN interface 'slcan:%s': there is no such serial line", path);
        break;
    case ENOTTY:
        (void)linux_fail(error, "CAN interface 'slcan:%s': this is no serial line", path);
        break;
    case EWOULDBLOCK:
        (void)linux_fail(error, "CAN interface 'slcan:%s': in use by another process", path);
        break;
    case EACCES:
        (void)linux_fail(error, "CAN interface 'slcan:%s': %s; add the user to the group dialout",
                         path, strerror(number));
        break;
    default:
        (void)linux_fail(error, "CAN interface 'slcan:%s': %s", path, strerror(number));
        break;
    }
}

static bool set_up(can_serial_t *self, const can_bus_options_t *options, linux_error_t *error) {
    const char *const path = options->interface;
    if (options->use_fd) {
        return linux_fail(error, "CAN interface 'slcan:%s': SLCAN has no CAN FD; switch it off",
                          path);
    }
    if (strlen(path) >= sizeof self->path) {
        return linux_fail(error, "CAN interface 'slcan:%.40s...': the path is too long", path);
    }
    if (!find_speed(options->serial_baud, &self->speed)) {
        return linux_fail(error,
                          "CAN interface 'slcan:%s': %u baud is no speed of a serial line; one of "
                          "9600 .. 4000000 (115200, 460800, 921600, 1000000 ...), or 0",
                          path, options->serial_baud);
    }
    if (!find_commands(options->bitrate, self->commands, sizeof self->commands)) {
        return linux_fail(
            error,
            "CAN interface 'slcan:%s': SLCAN cannot set %u bit/s; one of 10000, 20000, "
            "50000, 100000, 125000, 250000, 500000, 800000, 1000000, or 0",
            path, options->bitrate);
    }
    memcpy(self->path, path, strlen(path));
    self->takes_all = options->ids == NULL;
    for (uint32_t i = 0; !self->takes_all && i < options->id_count; i++) {
        const uint32_t id = options->ids[i];
        self->wanted[id / 8u] |= (uint8_t)(1u << (id % 8u));
    }
    return true;
}

can_bus_t *can_serial_open(const can_bus_options_t *options, linux_error_t *error) {
    can_serial_t *const self = calloc(1, sizeof *self);
    if (self == NULL) {
        (void)linux_fail(error, "out of memory");
        return NULL;
    }
    can_common_init(&self->bus, &backend);
    if (!set_up(self, options, error)) {
        free(self);
        return NULL;
    }
    const int number = open_line(self, &self->bus.fd);
    if (number != 0) {
        refuse(self->path, number, error);
        free(self);
        return NULL;
    }
    begin(self);
    return &self->bus;
}
