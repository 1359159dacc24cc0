/// The board's CAN bus beside its console: the same frames go out on both, and come from both.
#ifndef BUS_H
#define BUS_H

#include "can_stm32f4.h"
#include "clocks.h"
#include "node.h"

/// Frames that wait for the bus: those of two ticks and more.
#define BUS_QUEUE_FRAMES 32u
/// An older demand is of no use to a driver, and may be of a state that is long over.
#define BUS_MOST_US 25000u

typedef struct {
    can_stm32f4_t can;
    can_frame_t frames[BUS_QUEUE_FRAMES];
    uint32_t first;
    uint32_t count;
    uint32_t on_their_way; ///< as can_stm32f4_waiting had it
    uint32_t stuck_us;     ///< since the controller has taken or sent one
} bus_t;

/// What a tick says.
typedef struct {
    const can_frame_t *frames;
    uint32_t count;
    uint32_t elapsed_us; ///< since the last one
} bus_tick_t;

/// Only a crystal is good enough for CAN; without one, and in an emulator, there is no bus.
void bus_open(bus_t *bus, const clocks_t *clocks);

/// Puts a tick's frames behind those that wait; where there is no room the oldest gives way. While
/// the bus is off, and where nothing has gone out for BUS_MOST_US, nothing waits: what did is
/// dropped, and what the controller holds is taken back. Those of the queue are counted in *unsent.
void bus_put(bus_t *bus, const bus_tick_t *tick, can_unsent_t *unsent);

/// Sends what the controller takes and hands what has come to the node, a few frames at the most.
void bus_work(bus_t *bus, node_t *node);

#endif
