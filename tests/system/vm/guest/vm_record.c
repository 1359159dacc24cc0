/* vm_record INTERFACE NAME: watches the demand frames until a frame with id 0x7FF. Makes
 * /run/NAME.ready when it listens; prints a result NAME: how many frames, the last one's data, how
 * many were missing by the alive counter, wrong by the CRC, and with the output off, and the
 * longest time between two. */
#include "guest_bus.h"

#include "e2e.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { DEMAND = 0x010, END = 0x7FF };

typedef struct {
    uint8_t next_alive;
    can_frame_t last;
    int64_t last_ns;
    int64_t longest_ns;
    uint32_t frames;
    uint32_t jumps;
    uint32_t wrong;
    uint32_t off;
} record_t;

static void say_ready(const char *name) {
    char path[64];
    snprintf(path, sizeof path, "/run/%.40s.ready", name);
    const int fd = open(path, O_WRONLY | O_CREAT, 0644);
    if (fd < 0) {
        guest_fail(path);
    }
    close(fd);
}

static void take(record_t *record, const guest_frame_t *in) {
    const e2e_layout_t *layout = &quiesce_can_messages[QUIESCE_CAN_AT_CURRENT_DEMAND].e2e;
    if (!guest_is_demand(&in->frame)) {
        record->wrong++; /* some other node's: it is not the controller's last word */
        return;
    }
    const uint8_t alive = e2e_alive(layout, &in->frame);
    record->jumps += record->frames > 0 && alive != record->next_alive;
    record->next_alive = (uint8_t)((alive + 1u) % E2E_ALIVE_PERIOD);
    record->off += !guest_demand(&in->frame).is_enabled;
    if (record->frames > 0 && in->time_ns - record->last_ns > record->longest_ns) {
        record->longest_ns = in->time_ns - record->last_ns;
    }
    record->last_ns = in->time_ns;
    record->last = in->frame;
    record->frames++;
}

int main(int argc, char **argv) {
    static const uint32_t ids[] = {DEMAND, END};
    record_t record = {.frames = 0};
    guest_frame_t in;
    if (argc != 3) {
        return 2;
    }
    const int bus = guest_bus_open(argv[1], ids, 2);
    say_ready(argv[2]);
    while (guest_bus_receive(bus, &in) && in.frame.id != END) {
        take(&record, &in);
    }
    printf(
        "RESULT {\"name\": \"%s\", \"frames\": %" PRIu32 ", \"jumps\": %" PRIu32
        ", \"wrong\": %" PRIu32 ", \"off\": %" PRIu32 ", \"longest_us\": %" PRId64 ", \"last\": \"",
        argv[2], record.frames, record.jumps, record.wrong, record.off, record.longest_ns / 1000);
    for (uint32_t i = 0; i < record.last.length; i++) {
        printf("%02x", record.last.data[i]);
    }
    printf("\"}\n");
    return 0;
}
