/// The board's CAN bus beside its console: the same frames go out on both, and come from both.
#ifndef BUS_H
#define BUS_H

#include "can_stm32f4.h"
#include "clocks.h"
#include "free_node.h"

/// Frames that wait for the bus: those of two ticks and more.
#define BUS_QUEUE_FRAMES 32u

typedef struct {
    can_stm32f4_t can;
    can_frame_t frames[BUS_QUEUE_FRAMES];
    uint32_t first;
    uint32_t count;
} bus_t;

/// Only a crystal is good enough for CAN; without one, and in an emulator, there is no bus.
void bus_open(bus_t *bus, const clocks_t *clocks);

/// Puts a tick's frames behind those that wait; what finds no room is counted in *unsent.
void bus_put(bus_t *bus, const can_frame_t *frames, uint32_t count, can_unsent_t *unsent);

/// Sends what the controller takes and hands what has come to the node, a few frames at the most.
void bus_work(bus_t *bus, node_t *node);

#endif
