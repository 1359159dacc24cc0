#include "can_bus.h"

#include "can_backends.h"
#include "can_common.h"

#include <string.h>

#define SERIAL_PREFIX "slcan:"

static bool check(const can_bus_options_t *options, linux_error_t *error) {
    if (options->interface == NULL || options->interface[0] == '\0') {
        return linux_fail(error, "CAN interface '': give one as can0 or slcan:/dev/ttyACM0");
    }
    if (options->ids != NULL && options->id_count > CAN_BUS_MAX_IDS) {
        return linux_fail(error, "CAN interface '%s': %u ids to receive, at most %u",
                          options->interface, options->id_count, CAN_BUS_MAX_IDS);
    }
    for (uint32_t i = 0; options->ids != NULL && i < options->id_count; i++) {
        if (options->ids[i] > CAN_MAX_STANDARD_ID) {
            return linux_fail(error, "CAN interface '%s': id 0x%X is no standard id",
                              options->interface, options->ids[i]);
        }
    }
    return true;
}

can_bus_t *can_bus_open(const can_bus_options_t *options, linux_error_t *error) {
    if (!check(options, error)) {
        return NULL;
    }
    if (strncmp(options->interface, SERIAL_PREFIX, strlen(SERIAL_PREFIX)) == 0) {
        can_bus_options_t serial = *options;
        serial.interface += strlen(SERIAL_PREFIX);
        return can_serial_open(&serial, error);
    }
    return can_socket_open(options, error);
}

void can_bus_close(can_bus_t *bus) {
    if (bus != NULL) {
        bus->backend->close(bus);
    }
}

bool can_bus_receive(can_bus_t *bus, can_frame_t *frame, int64_t *time_ns) {
    int64_t ignored_ns;
    if (bus->fd < 0 ||
        !bus->backend->receive(bus, frame, time_ns != NULL ? time_ns : &ignored_ns)) {
        return false;
    }
    can_common_count(&bus->counters.received, 1);
    return true;
}

bool can_bus_send(can_bus_t *bus, const can_frame_t *frame) {
    const bool is_sent = bus->fd >= 0 && bus->backend->send(bus, frame);
    can_common_count(is_sent ? &bus->counters.sent : &bus->counters.tx_dropped, 1);
    return is_sent;
}

/// Hands over what recovery needs. A bus that is off keeps its file: it tells of the restart.
static void ask(can_bus_t *bus, int64_t now_ns) {
    can_recovery_t *const recovery = &bus->recovery;
    const bool is_off = bus->state == CAN_BUS_OFF;
    bus->retry_ns = now_ns + (is_off ? bus->restart_ns : CAN_REOPEN_NS);
    recovery->reason = bus->state;
    recovery->fd = is_off ? -1 : bus->fd;
    recovery->gone_fd = bus->gone_fd;
    recovery->is_new = false;
    recovery->is_up = false;
    recovery->answer = 0;
    bus->fd = is_off ? bus->fd : -1;
    bus->gone_fd = -1;
    atomic_store_explicit(&recovery->stage, CAN_RECOVERY_ASKED, memory_order_release);
}

static void adopt(can_bus_t *bus) {
    if (bus->recovery.reason == CAN_BUS_DOWN) {
        bus->fd = bus->recovery.fd;
        bus->recovery.fd = -1;
    }
    bus->backend->adopt(bus);
    atomic_store_explicit(&bus->recovery.stage, CAN_RECOVERY_IDLE, memory_order_relaxed);
}

bool can_bus_maintain(can_bus_t *bus, int64_t now_ns) {
    const int stage = atomic_load_explicit(&bus->recovery.stage, memory_order_acquire);
    if (stage == CAN_RECOVERY_ASKED || stage == CAN_RECOVERY_TAKEN) {
        return false;
    }
    if (stage == CAN_RECOVERY_DONE) {
        adopt(bus);
    }
    const bool is_wrong = bus->state == CAN_BUS_DOWN || bus->state == CAN_BUS_OFF;
    if (!is_wrong || now_ns < bus->retry_ns) {
        return false;
    }
    ask(bus, now_ns);
    return true;
}

void can_bus_recover(can_bus_t *bus) {
    can_recovery_t *const recovery = &bus->recovery;
    int expected = CAN_RECOVERY_ASKED;
    if (!atomic_compare_exchange_strong_explicit(&recovery->stage, &expected, CAN_RECOVERY_TAKEN,
                                                 memory_order_acquire, memory_order_relaxed)) {
        return;
    }
    can_common_close(&recovery->gone_fd);
    bus->backend->recover(bus);
    atomic_store_explicit(&recovery->stage, CAN_RECOVERY_DONE, memory_order_release);
}

void can_bus_repair(can_bus_t *bus, int64_t now_ns) {
    if (can_bus_maintain(bus, now_ns)) {
        can_bus_recover(bus);
        (void)can_bus_maintain(bus, now_ns);
    }
}

void can_bus_look(can_bus_t *bus) {
    if (bus->fd >= 0 && bus->backend->look != NULL) {
        bus->backend->look(bus);
    }
}

can_bus_state_t can_bus_state(const can_bus_t *bus) {
    return bus->state;
}

const can_bus_counters_t *can_bus_counters(const can_bus_t *bus) {
    return &bus->counters;
}

const can_bus_event_t *can_bus_last_event(const can_bus_t *bus) {
    return &bus->event;
}

int can_bus_fd(const can_bus_t *bus) {
    return bus->fd;
}
