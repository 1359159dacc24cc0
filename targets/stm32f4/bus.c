#include "bus.h"

#include "board.h"

#define RECEIVED_AT_ONCE 4u

void bus_open(bus_t *bus, const clocks_t *clocks) {
    if (clocks->source == CLOCK_CRYSTAL) {
        (void)can_stm32f4_open(&bus->can, &stm32f4_board.can, clocks->apb1_Hz);
    }
}

void bus_put(bus_t *bus, const can_frame_t *frames, uint32_t count, can_unsent_t *unsent) {
    can_stm32f4_watch(&bus->can);
    for (uint32_t i = 0; bus->can.is_open && i < count; i++) {
        if (bus->count == BUS_QUEUE_FRAMES) {
            can_unsent_count(unsent, frames[i].id);
            continue;
        }
        bus->frames[(bus->first + bus->count) % BUS_QUEUE_FRAMES] = frames[i];
        bus->count++;
    }
}

void bus_work(bus_t *bus, node_t *node) {
    can_frame_t frame;
    while (bus->count > 0u && can_stm32f4_send(&bus->can, &bus->frames[bus->first])) {
        bus->first = (bus->first + 1u) % BUS_QUEUE_FRAMES;
        bus->count--;
    }
    for (uint32_t i = 0; i < RECEIVED_AT_ONCE && can_stm32f4_receive(&bus->can, &frame); i++) {
        node_receive(node, &frame);
    }
}
