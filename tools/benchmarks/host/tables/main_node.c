// The controller with its CAN interface as a program of this machine: SLCAN on a serial line, ticks
// from the clock, samples and the operator's enable from the bus, records as files. Runs until it
// is killed. Where its reader is slow it waits, so that a busy machine loses no frame; ticks that
// it missed do not come.
//
// table_node LINE FOLDER
#include "quiesce_can.h"
#include "records.h"
#include "slcan.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#define NS_PER_S 1000000000L
#define MOST_LATE_NS 20000000L
#define SAMPLE_MS 200 ///< that a sample is waited for

typedef struct {
    int line;
    slcan_decoder_t decoder;
    records_t records;
    node_t node;
} program_t;

// Returns whether a sample was among what came.
static bool receive(program_t *self) {
    uint8_t bytes[1024];
    bool has_sample = false;
    const ssize_t count = read(self->line, bytes, sizeof bytes);
    for (ssize_t i = 0; i < count; i++) {
        can_frame_t frame;
        if (slcan_decode(&self->decoder, bytes[i], &frame)) {
            has_sample = has_sample || frame.id == QUIESCE_CAN_ACCEL_SAMPLE_FRAME_ID;
            node_receive(&self->node, &frame);
        }
    }
    return has_sample;
}

static void receive_with_sample(program_t *self) {
    struct pollfd more = {.fd = self->line, .events = POLLIN};
    while (!receive(self) && poll(&more, 1, SAMPLE_MS) > 0) {
    }
}

// Returns false iff the line is gone.
static bool write_all(int line, const uint8_t *bytes, size_t length) {
    size_t done = 0;
    while (done < length) {
        const ssize_t count = write(line, bytes + done, length - done);
        if (count >= 0) {
            done += (size_t)count;
        } else if (errno == EAGAIN) {
            struct pollfd room = {.fd = line, .events = POLLOUT};
            (void)poll(&room, 1, -1);
        } else if (errno != EINTR) {
            return false;
        }
    }
    return true;
}

static bool tick(program_t *self) {
    static const node_inputs_t inputs = {.ticks_elapsed = 1};
    can_frame_t frames[NODE_MAX_FRAMES];
    uint8_t bytes[NODE_MAX_FRAMES * SLCAN_MAX_BYTES];
    size_t length = 0;
    const uint32_t count = node_tick(&self->node, &inputs, frames);
    for (uint32_t i = 0; i < count; i++) {
        length += slcan_encode(&frames[i], &bytes[length]);
    }
    return write_all(self->line, bytes, length);
}

static void wait_until_due(struct timespec *due, long period_ns) {
    struct timespec now;
    due->tv_nsec += period_ns;
    if (due->tv_nsec >= NS_PER_S) {
        due->tv_nsec -= NS_PER_S;
        due->tv_sec++;
    }
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    if ((now.tv_sec - due->tv_sec) * NS_PER_S + now.tv_nsec - due->tv_nsec > MOST_LATE_NS) {
        *due = now;
    }
    (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, due, NULL);
}

static bool start(program_t *self) {
    static const node_sources_t sources = {.enable = NODE_ENABLE_CAN, .sensors_on_bus = 1};
    quiesce_params_t params;
    quiesce_params_default(&params);
    (void)records_params(&self->records, &params);
    slcan_decoder_init(&self->decoder);
    if (!node_init(&self->node, NULL, &params, sources)) {
        return false;
    }
    node_use_store(&self->node, records_store, &self->records);
    records_resume(&self->records, &self->node);
    return true;
}

int main(int count, char **arguments) {
    static program_t program;
    struct timespec due;
    if (count != 3) {
        (void)fprintf(stderr, "usage: table_node LINE FOLDER\n");
        return 2;
    }
    program.line = open(arguments[1], O_RDWR | O_NOCTTY | O_NONBLOCK);
    program.records.folder = arguments[2];
    if (program.line < 0 || !start(&program)) {
        (void)fprintf(stderr, "table_node: %s cannot be opened, or what is kept is refused\n",
                      arguments[1]);
        return 2;
    }
    (void)clock_gettime(CLOCK_MONOTONIC, &due);
    do {
        wait_until_due(&due, NS_PER_S / program.node.params.tick_rate_Hz);
        receive_with_sample(&program);
    } while (tick(&program));
    return 0;
}
