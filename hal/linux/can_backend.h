/// What the two kinds of CAN bus have in common. A backend's own state begins with a can_bus_t.
#ifndef CAN_BACKEND_H
#define CAN_BACKEND_H

#include "can_bus.h"

/// Pause between two looks for an interface that is gone.
#define CAN_REOPEN_NS INT64_C(100000000)
#define CAN_RESTART_DEFAULT_MS 100u

typedef struct {
    bool (*receive)(can_bus_t *bus, can_frame_t *frame, int64_t *time_ns);
    bool (*send)(can_bus_t *bus, const can_frame_t *frame);
    void (*maintain)(can_bus_t *bus, int64_t now_ns);
    void (*close)(can_bus_t *bus);
} can_backend_t;

struct can_bus {
    const can_backend_t *backend;
    int fd; ///< -1: gone
    can_bus_state_t state;
    can_bus_counters_t counters;
    can_bus_event_t event;
    int64_t retry_ns; ///< next look for what is gone, next restart; 0: at once
};

/// Each returns NULL and says why. The options were checked by can_bus_open.
can_bus_t *can_socket_open(const can_bus_options_t *options, linux_error_t *error);
can_bus_t *can_serial_open(const can_bus_options_t *options, linux_error_t *error);

/// Adds to a counter, which stops at its greatest value.
void can_bus_count(uint32_t *counter, uint32_t by);

/// Notes what happened, unless that is what happened last.
__attribute__((format(printf, 2, 3))) void can_bus_note(can_bus_t *bus, const char *format, ...);

/// The bus went down or vanished: counted and noted where it was not so before.
void can_bus_went_down(can_bus_t *bus, const char *why);

#endif
