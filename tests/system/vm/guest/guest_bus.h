/// What the guest's programs share: a raw CAN socket, and the protected messages of the nodes that
/// they play. They end with one line on stderr where the system refuses something.
#ifndef GUEST_BUS_H
#define GUEST_BUS_H

#include "can_frame.h"
#include "quiesce_can_tables.h"

#include <stdint.h>

/// A received frame.
typedef struct {
    can_frame_t frame;
    int64_t time_ns; ///< CLOCK_MONOTONIC of the kernel's time stamp
} guest_frame_t;

/// Opens the interface. ids: standard ids to receive, id_count of them; 0: none.
int guest_bus_open(const char *interface, const uint32_t *ids, uint32_t id_count);

/// Waits for the next frame. Returns false iff the interface went down.
bool guest_bus_receive(int bus, guest_frame_t *received);

/// Sends, and waits while the interface's queue is full. Returns false iff it is down.
bool guest_bus_send(int bus, const can_frame_t *frame);

/// The demand frame's contents.
typedef struct {
    int32_t current_mA;
    bool is_enabled;
    bool wants_release; ///< only an enable that rises after this state arms
} guest_demand_t;

/// Whether the controller may have sent it: shape and CRC are right. Others use the id, too.
bool guest_is_demand(const can_frame_t *frame);

guest_demand_t guest_demand(const can_frame_t *frame);

/// A sensor node's next sample, and an operator's command. *alive is the sender's counter.
void guest_sample(can_frame_t *frame, int32_t accel_counts, uint8_t *alive);
/// An operator's hand: lets go for a few commands where a demand wants it, then enables.
typedef struct {
    uint32_t left; ///< commands to let go in
} guest_hand_t;
void guest_hand_see(guest_hand_t *hand, const guest_demand_t *demand);
bool guest_hand_enables(guest_hand_t *hand);

void guest_command(can_frame_t *frame, bool enable, bool fault_reset, uint8_t *alive);

/// The frame's protection, again: for frames that were changed after it.
void guest_protect(can_frame_t *frame, uint32_t message, uint8_t *alive);

int64_t guest_now_ns(void);

/// Sleeps to an absolute time of CLOCK_MONOTONIC.
void guest_sleep_until(int64_t time_ns);

/// SCHED_FIFO for the calling thread.
void guest_real_time(int priority);

_Noreturn void guest_fail(const char *what);

/// A decimal argument within low .. high; ends the program where it is none.
int32_t guest_number(const char *text, int32_t low, int32_t high);

#endif
