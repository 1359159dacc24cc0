/// What a CAN bus says of itself, and what it is opened with.
#ifndef CAN_TYPES_H
#define CAN_TYPES_H

#include <stdbool.h>
#include <stdint.h>

typedef struct can_bus can_bus_t;

typedef struct {
    const char *interface;
    bool use_fd;          ///< send CAN FD frames with bit-rate switching; SocketCAN only
    uint32_t serial_baud; ///< SLCAN: of the serial line, 0: leave it as it is
    uint32_t bitrate;     ///< SLCAN: bit/s of the bus: the adapter is closed, set and opened with
                          ///< C, Sn and O; 0: it is sent no command. SocketCAN: ip link sets it
    const uint32_t *ids;  ///< standard ids to receive; NULL: all
    uint32_t id_count;    ///< at most CAN_BUS_MAX_IDS
    uint32_t restart_ms;  ///< pause before a restart after bus-off; 0: 100
} can_bus_options_t;

#define CAN_BUS_MAX_IDS 32u

typedef enum {
    CAN_BUS_UP = 0,
    CAN_BUS_DOWN = 1,    ///< the interface is down or gone; it is looked for again
    CAN_BUS_OFF = 2,     ///< bus-off; a restart is asked for after restart_ms
    CAN_BUS_PASSIVE = 3, ///< error passive: still works
} can_bus_state_t;

/// Since the opening, saturating.
typedef struct {
    uint32_t received;
    uint32_t sent;
    uint32_t tx_dropped;   ///< frames that the interface did not take (queue full, down)
    uint32_t rx_dropped;   ///< frames that the kernel dropped because we were late (SO_RXQ_OVFL)
    uint32_t error_frames; ///< from the controller chip; SLCAN: commands that the adapter refused
    uint32_t malformed;    ///< SLCAN lines that are no frame; CAN FD frames of more than 8 bytes
    uint32_t bus_off;
    uint32_t restarts; ///< asked for
    uint32_t overruns; ///< bytes or frames that the hardware or its driver lost, because nobody
                       ///< took them in time: of a serial line TIOCGICOUNT, else error frames
    uint32_t down;     ///< times that the interface went down or vanished
} can_bus_counters_t;

/// What happened to the bus last: for the log, once a change.
typedef struct {
    uint32_t number; ///< counts changes; 0: nothing has happened
    char text[96];   ///< one line, without the interface's name
} can_bus_event_t;

#endif
