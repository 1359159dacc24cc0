/// Stack use of an image: start-up paints the stack, the high-water mark is where the paint ends.
#ifndef STACK_H
#define STACK_H

#include <stdint.h>

#define STACK_PAINT 0xC0DEC0DEu

/// Deepest stack use since start-up, in bytes. O(stack size).
uint32_t stack_high_water_bytes(void);

/// Size of the stack in bytes.
uint32_t stack_size_bytes(void);

#endif
