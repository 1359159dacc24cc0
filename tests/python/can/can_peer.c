// A controller for the tests of the CAN tools: the firmware's node with a simulated sensor, at
// 1 kHz, with SLCAN on a file descriptor. Runs until its input ends or SIGTERM. Where its reader is
// slow it waits, so that a busy machine loses no frames; the ticks that it missed do not come.
//
// can_peer FD [--drop N] [--corrupt N] [--no-store] [--store FOLDER] [--silent] [--idle]
//          [--operator] [--interface N] [--images FILE --board NAME [--bad VERSION]]
//   --drop N       the bus loses every Nth frame
//   --corrupt N    every Nth frame has a bit flipped
//   --store DIR    records are files in it, which the next start finds
//   --silent       answers no requests
//   --idle         the operator lets go; SIGUSR1: takes it, lets go again, ...
//   --operator     the enable is that of OperatorCommand, and so is the clock: between two of its
//                  frames are the ticks of its cycle, however busy the machine
//   --interface N  says that its messages are of this version
//   --images FILE  its flash, with boot code's two places for an image (image_peer.h)
//   --bad VERSION  an image of that version ends as soon as it is started
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "image_peer.h"
#include "node.h"
#include "quiesce_can.h"
#include "slcan.h"

#define TICK_NS 1000000L
#define NS_PER_S 1000000000L
#define MAX_LATE_NS 100000000L
#define OPERATOR_TICKS 100u // in a cycle of OperatorCommand
#define LOOK_MS 20
#define PI 3.14159265358979

typedef struct {
    int fd;
    unsigned drop;
    unsigned corrupt;
    unsigned interface_version; // 0: its own
    bool has_store;
    const char *store; // folder, NULL: records are forgotten
    bool is_idle;      // the operator lets go
    bool is_silent;
    bool has_operator;
    bool has_images;
    unsigned operated; // ticks that its frames have brought
    unsigned sent;
    can_unsent_t unsent;
    slcan_decoder_t decoder;
    node_t node;
} peer_t;

static volatile sig_atomic_t stop;
static volatile sig_atomic_t has_turned; // the operator, an odd number of times

static void end(int number) {
    (void)number;
    stop = 1;
}

static void turn(int number) {
    (void)number;
    has_turned = !has_turned;
}

static FILE *open_record(const peer_t *peer, keeper_record_t record, const char *mode) {
    char name[512];
    (void)snprintf(name, sizeof name, "%s/record%d", peer->store, (int)record);
    return fopen(name, mode);
}

static keeper_answer_t keep(void *context, keeper_record_t record, const uint32_t *words,
                            uint32_t count) {
    const peer_t *peer = context;
    if (!peer->has_store || peer->store == NULL) {
        return peer->has_store ? KEEPER_DONE : KEEPER_FAILED;
    }
    FILE *file = open_record(peer, record, "wb");
    const bool is_kept = file != NULL && fwrite(words, sizeof *words, count, file) == count;
    return file != NULL && fclose(file) == 0 && is_kept ? KEEPER_DONE : KEEPER_FAILED;
}

// What an earlier run has kept: one write each.
static void find(peer_t *peer, keeper_record_t record) {
    static uint32_t words[QUIESCE_TABLE_WORDS];
    FILE *file = peer->store != NULL ? open_record(peer, record, "rb") : NULL;
    if (file == NULL) {
        return;
    }
    const table_found_t found = {
        .record = record,
        .source = TABLE_FROM_STORE,
        .words = words,
        .count = (uint32_t)fread(words, sizeof *words, QUIESCE_TABLE_WORDS, file),
        .writes = 1,
    };
    (void)fclose(file);
    (void)node_found(&peer->node, &found);
}

static void receive(peer_t *peer) {
    uint8_t bytes[1024];
    const ssize_t count = read(peer->fd, bytes, sizeof bytes);
    for (ssize_t i = 0; i < count; i++) {
        can_frame_t frame;
        if (slcan_decode(&peer->decoder, bytes[i], &frame) && !peer->is_silent) {
            node_receive(&peer->node, &frame);
            peer->operated +=
                frame.id == QUIESCE_CAN_OPERATOR_COMMAND_FRAME_ID ? OPERATOR_TICKS : 0u;
        }
    }
}

static bool write_all(int fd, const uint8_t *bytes, size_t length) {
    size_t done = 0;
    while (done < length && !stop) {
        const ssize_t count = write(fd, bytes + done, length - done);
        if (count >= 0) {
            done += (size_t)count;
        } else if (errno == EAGAIN) {
            struct pollfd room = {.fd = fd, .events = POLLOUT};
            (void)poll(&room, 1, -1);
        } else if (errno != EINTR) {
            return false;
        }
    }
    return done == length;
}

static void send_frame(peer_t *peer, const can_frame_t *frame) {
    can_frame_t wire = *frame;
    peer->sent++;
    if (peer->drop != 0u && peer->sent % peer->drop == 0u) {
        return;
    }
    if (peer->corrupt != 0u && peer->sent % peer->corrupt == 0u) {
        wire.data[0] ^= 0x10u;
    }
    if (peer->interface_version != 0u && frame->id == QUIESCE_CAN_IDENTIFICATION_FRAME_ID) {
        wire.data[3] = (uint8_t)peer->interface_version;
    }
    uint8_t line[SLCAN_MAX_BYTES];
    if (!write_all(peer->fd, line, slcan_encode(&wire, line))) {
        can_unsent_count(&peer->unsent, frame->id);
    }
}

static void tick(peer_t *peer, unsigned number) {
    const double counts = 20000.0 * sin(2.0 * PI * 8.0 * number / 1000.0);
    const node_inputs_t inputs = {
        .enable = number > 0 && peer->is_idle == (has_turned != 0), // its edge arms
        .sensor = {{.counts = (int32_t)counts + (int32_t)(number * 7919u % 13u), .is_fresh = true}},
        .ticks_elapsed = 1,
        .work_us = 20,
        .unsent = peer->unsent,
    };
    can_frame_t frames[NODE_MAX_FRAMES];
    const uint32_t count = node_tick(&peer->node, &inputs, frames);
    for (uint32_t i = 0; i < count; i++) {
        send_frame(peer, &frames[i]);
    }
}

static void add_tick(struct timespec *time) {
    time->tv_nsec += TICK_NS;
    if (time->tv_nsec >= NS_PER_S) {
        time->tv_nsec -= NS_PER_S;
        time->tv_sec++;
    }
}

static bool is_long_past(const struct timespec *due) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (now.tv_sec - due->tv_sec) * NS_PER_S + (now.tv_nsec - due->tv_nsec) > MAX_LATE_NS;
}

static bool start(peer_t *peer) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    const node_sources_t sources = {
        .enable = peer->has_operator ? NODE_ENABLE_CAN : NODE_ENABLE_BOARD,
    };
    slcan_decoder_init(&peer->decoder);
    if (!node_init(&peer->node, NULL, &params, sources)) {
        return false;
    }
    node_use_store(&peer->node, keep, peer);
    find(peer, KEEPER_LAW_TABLE);
    find(peer, KEEPER_TRACKER_TABLE);
    find(peer, KEEPER_LEARNT);
    return !peer->has_images || image_peer_start(&peer->node);
}

static void run_operated(peer_t *peer) {
    for (unsigned number = 0; !stop;) {
        struct pollfd input = {.fd = peer->fd, .events = POLLIN};
        (void)poll(&input, 1, LOOK_MS);
        receive(peer);
        for (; number < peer->operated && !stop; number++) {
            tick(peer, number);
        }
    }
}

static void run(peer_t *peer) {
    struct timespec due;
    (void)clock_gettime(CLOCK_MONOTONIC, &due);
    for (unsigned number = 0; !stop; number++) {
        receive(peer);
        tick(peer, number);
        if (peer->has_images && image_peer_tick(&peer->node) && !start(peer)) {
            return;
        }
        add_tick(&due);
        if (is_long_past(&due)) {
            (void)clock_gettime(CLOCK_MONOTONIC, &due);
        }
        (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
    }
}

static const char *word(int argc, char **argv, const char *name) {
    for (int i = 2; i + 1 < argc; i++) {
        if (strcmp(argv[i], name) == 0) {
            return argv[i + 1];
        }
    }
    return NULL;
}

static unsigned option(int argc, char **argv, const char *name) {
    const char *text = word(argc, argv, name);
    return text != NULL ? (unsigned)strtoul(text, NULL, 10) : 0;
}

static bool flag(int argc, char **argv, const char *name) {
    for (int i = 2; i < argc; i++) {
        if (strcmp(argv[i], name) == 0) {
            return true;
        }
    }
    return false;
}

int main(int argc, char **argv) {
    static peer_t peer;
    if (argc < 2) {
        return 2;
    }
    peer.fd = (int)strtol(argv[1], NULL, 10);
    peer.drop = option(argc, argv, "--drop");
    peer.corrupt = option(argc, argv, "--corrupt");
    peer.interface_version = option(argc, argv, "--interface");
    peer.has_store = !flag(argc, argv, "--no-store");
    peer.store = word(argc, argv, "--store");
    peer.is_idle = flag(argc, argv, "--idle");
    peer.is_silent = flag(argc, argv, "--silent");
    (void)signal(SIGTERM, end);
    (void)signal(SIGUSR1, turn);
    peer.has_operator = flag(argc, argv, "--operator");
    peer.has_images = word(argc, argv, "--images") != NULL;
    if (peer.has_images &&
        !image_peer_open(word(argc, argv, "--images"), word(argc, argv, "--board"),
                         option(argc, argv, "--bad"))) {
        return 2;
    }
    if (!start(&peer)) {
        return 1;
    }
    (peer.has_operator ? run_operated : run)(&peer);
    return 0;
}
