#include "bus.h"

#include "board.h"

#define RECEIVED_AT_ONCE 4u

void bus_open(bus_t *bus, const clocks_t *clocks) {
    if (clocks->source == CLOCK_CRYSTAL) {
        (void)can_stm32f4_open(&bus->can, &stm32f4_board.can, clocks->apb1_Hz);
    }
}

static void take_oldest(bus_t *bus) {
    bus->first = (bus->first + 1u) % BUS_QUEUE_FRAMES;
    bus->count--;
}

static void drop_oldest(bus_t *bus, can_unsent_t *unsent) {
    can_unsent_count(unsent, bus->frames[bus->first].id);
    take_oldest(bus);
}

static void drop_all(bus_t *bus, can_unsent_t *unsent) {
    can_stm32f4_abort(&bus->can);
    while (bus->count > 0u) {
        drop_oldest(bus, unsent);
    }
    bus->stuck_us = 0;
}

// Something goes out where the frames on their way are no longer the same ones, or none are.
static void watch(bus_t *bus, uint32_t elapsed_us) {
    const uint32_t on_their_way = can_stm32f4_waiting(&bus->can);
    const bool moves = on_their_way == 0u || on_their_way != bus->on_their_way;
    bus->on_their_way = on_their_way;
    bus->stuck_us = moves ? 0u : bus->stuck_us + elapsed_us;
    can_stm32f4_watch(&bus->can);
}

void bus_put(bus_t *bus, const bus_tick_t *tick, can_unsent_t *unsent) {
    watch(bus, tick->elapsed_us);
    for (uint32_t i = 0; bus->can.is_open && i < tick->count; i++) {
        if (bus->count == BUS_QUEUE_FRAMES) {
            drop_oldest(bus, unsent);
        }
        bus->frames[(bus->first + bus->count) % BUS_QUEUE_FRAMES] = tick->frames[i];
        bus->count++;
    }
    if (bus->can.is_bus_off || bus->stuck_us >= BUS_MOST_US) {
        drop_all(bus, unsent);
    }
}

void bus_work(bus_t *bus, node_t *node) {
    can_frame_t frame;
    while (bus->count > 0u && can_stm32f4_send(&bus->can, &bus->frames[bus->first])) {
        take_oldest(bus);
        bus->stuck_us = 0;
    }
    for (uint32_t i = 0; i < RECEIVED_AT_ONCE && can_stm32f4_receive(&bus->can, &frame); i++) {
        node_receive(node, &frame);
    }
}
