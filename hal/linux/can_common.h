/// What the two kinds of CAN bus have in common. A backend's own state begins with a can_bus_t.
#ifndef CAN_COMMON_H
#define CAN_COMMON_H

#include "can_frame.h"
#include "can_types.h"

#include <stdatomic.h>

/// Pause between two looks for an interface that is gone.
#define CAN_REOPEN_NS INT64_C(100000000)
#define CAN_RESTART_DEFAULT_MS 100u

typedef enum {
    CAN_RECOVERY_IDLE = 0,  ///< the user's
    CAN_RECOVERY_ASKED = 1, ///< nobody's: whoever calls can_bus_recover first takes it
    CAN_RECOVERY_TAKEN = 2, ///< that thread's
    CAN_RECOVERY_DONE = 3,  ///< the user's again
} can_recovery_stage_t;

/// What the user of a bus and can_bus_recover hand to each other. `stage` says who may touch the
/// rest. The file descriptors go with it: each has one owner at any time.
typedef struct {
    atomic_int stage;       ///< of can_recovery_stage_t
    can_bus_state_t reason; ///< DOWN: look for the interface; OFF: ask for the restart
    int fd;                 ///< in: to be looked at; out: to be used; -1: none
    int gone_fd;            ///< in: to be closed; -1: none
    bool is_new;            ///< out: fd was opened
    bool is_up;             ///< out: the interface can be used
    int answer;             ///< out: the kernel's to the restart, an errno; 0: done
} can_recovery_t;

/// recover is called by the thread that has taken bus->recovery; it touches nothing but that, and
/// of the backend's state what never changes or is said to be its own. adopt, like all the others,
/// belongs to the user of the bus.
typedef struct {
    bool (*receive)(can_bus_t *bus, can_frame_t *frame, int64_t *time_ns);
    bool (*send)(can_bus_t *bus, const can_frame_t *frame);
    void (*recover)(can_bus_t *bus);
    void (*adopt)(can_bus_t *bus); ///< the file descriptor is in place already
    void (*look)(can_bus_t *bus);  ///< may do a system call that does not block; NULL: no need
    void (*close)(can_bus_t *bus);
} can_backend_t;

struct can_bus {
    const can_backend_t *backend;
    int fd;      ///< -1: gone, or handed to can_bus_recover
    int gone_fd; ///< of what has vanished, still open; -1: none
    can_bus_state_t state;
    can_bus_counters_t counters;
    can_bus_event_t event;
    int64_t retry_ns;   ///< next look for what is gone, next restart; 0: at once
    int64_t restart_ns; ///< pause between restarts
    can_recovery_t recovery;
};

/// A bus without a file descriptor.
void can_common_init(can_bus_t *bus, const can_backend_t *backend);

/// Closes a file where there is one; it is none from then on.
void can_common_close(int *fd);

/// Closes what is still open of it, whoever had it last.
void can_common_close_files(can_bus_t *bus);

/// Adds to a counter, which stops at its greatest value.
void can_common_count(uint32_t *counter, uint32_t by);

/// Notes what happened, unless that is what happened last.
__attribute__((format(printf, 2, 3))) void can_common_note(can_bus_t *bus, const char *format, ...);

/// The bus went down: counted and noted where it was not so before.
void can_common_went_down(can_bus_t *bus, const char *why);

/// It is gone: its file descriptor is not used any more.
void can_common_vanished(can_bus_t *bus, const char *why);

#endif
