#include "can_common.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void can_common_init(can_bus_t *bus, const can_backend_t *backend) {
    *bus = (can_bus_t){
        .backend = backend,
        .fd = -1,
        .gone_fd = -1,
        .state = CAN_BUS_DOWN,
        .recovery = {.fd = -1, .gone_fd = -1},
    };
}

void can_common_close(int *fd) {
    if (*fd >= 0) {
        (void)close(*fd);
    }
    *fd = -1;
}

void can_common_close_files(can_bus_t *bus) {
    can_common_close(&bus->fd);
    can_common_close(&bus->gone_fd);
    can_common_close(&bus->recovery.fd);
    can_common_close(&bus->recovery.gone_fd);
}

void can_common_count(uint32_t *counter, uint32_t by) {
    *counter = by > UINT32_MAX - *counter ? UINT32_MAX : *counter + by;
}

void can_common_note(can_bus_t *bus, const char *format, ...) {
    char text[sizeof bus->event.text];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (strcmp(text, bus->event.text) != 0) {
        memcpy(bus->event.text, text, sizeof text);
        can_common_count(&bus->event.number, 1);
    }
}

void can_common_went_down(can_bus_t *bus, const char *why) {
    if (bus->state != CAN_BUS_DOWN) {
        can_common_count(&bus->counters.down, 1);
        bus->state = CAN_BUS_DOWN;
        bus->retry_ns = 0;
    }
    can_common_note(bus, "%s", why);
}

void can_common_vanished(can_bus_t *bus, const char *why) {
    can_common_went_down(bus, why);
    bus->gone_fd = bus->fd;
    bus->fd = -1;
}
