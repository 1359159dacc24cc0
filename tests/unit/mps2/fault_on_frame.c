// Takes the place of node_receive in an image of the tests: a frame of its own makes the processor
// fault, all others are taken as ever.
#include "node.h"

#define FAULT_ID 0x7F0u

void __real_node_receive(node_t *node, const can_frame_t *frame); // the linker's names
void __wrap_node_receive(node_t *node, const can_frame_t *frame);

void __wrap_node_receive(node_t *node, const can_frame_t *frame) {
    if (frame->id == FAULT_ID) {
        __asm__ volatile("udf #0");
    }
    __real_node_receive(node, frame);
}
