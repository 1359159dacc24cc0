/// A CAN bus: a SocketCAN interface ("can0"), or an adapter that speaks SLCAN on a serial line
/// ("slcan:/dev/ttyACM0", a pty too). can_socket.c and can_serial.c are the backends.
///
/// One thread uses a bus. Opening, closing, can_bus_recover and can_bus_repair may block, nothing
/// else does.
#ifndef CAN_BUS_H
#define CAN_BUS_H

#include "can_frame.h"
#include "can_types.h"
#include "linux_error.h"

/// Opens the bus. What an SLCAN line received before is dropped: it may be old. Returns NULL where
/// there is no such interface or no permission; an interface that is down is opened (state
/// CAN_BUS_DOWN) and used as soon as it is up.
can_bus_t *can_bus_open(const can_bus_options_t *options, linux_error_t *error);

void can_bus_close(can_bus_t *bus);

/// Next received frame; never blocks. Error frames are taken care of inside.
/// time_ns (may be NULL): CLOCK_MONOTONIC of the kernel's time stamp, or of the read (SLCAN).
bool can_bus_receive(can_bus_t *bus, can_frame_t *frame, int64_t *time_ns);

/// Never blocks. Returns false iff the frame was dropped (counted).
bool can_bus_send(can_bus_t *bus, const can_frame_t *frame);

/// Recovery, the part of the thread that uses the bus: call once a tick; now_ns: CLOCK_MONOTONIC.
/// Does no system call. Takes what can_bus_recover has done, and asks for it where something is
/// wrong and it is time for the next attempt: returns true iff it has just asked. Meanwhile the bus
/// can be used as ever; while what vanished is looked for it drops frames.
bool can_bus_maintain(can_bus_t *bus, int64_t now_ns);

/// Recovery, the part that may block (open, close, serial settings, the kernel's routing socket):
/// does what can_bus_maintain has asked for, or nothing. For any thread, beside the one that uses
/// the bus; not beside can_bus_close.
void can_bus_recover(can_bus_t *bus);

/// Both, where one thread does everything and may block.
void can_bus_repair(can_bus_t *bus, int64_t now_ns);

/// Once a second, by the user of the bus: asks the kernel what a serial line has lost. One system
/// call, which does not block.
void can_bus_look(can_bus_t *bus);

can_bus_state_t can_bus_state(const can_bus_t *bus);
const can_bus_counters_t *can_bus_counters(const can_bus_t *bus);

const can_bus_event_t *can_bus_last_event(const can_bus_t *bus);

/// For poll(). -1, which poll() passes over, while the bus is gone or looked for; another one when
/// it is back.
int can_bus_fd(const can_bus_t *bus);

#endif
