/// One call between the markers of the instruction counter, on a stack of its own.
#ifndef COUNTED_CALL_H
#define COUNTED_CALL_H

#include <stdint.h>

/// Any function, cast; it takes at most three words, in r0 .. r2.
typedef void (*counted_function_t)(void);

/// Paints the stack of the counted calls. Before the first of them.
void counted_call_init(void);

/// Calls function(a, b, c). Counted: the call instruction and all that runs until it has returned.
void counted_call(counted_function_t function, uintptr_t a, uintptr_t b, uintptr_t c);

/// Deepest use of that stack so far, in bytes.
uint32_t counted_call_stack_bytes(void);

/// Size of that stack; a use of all of it may have been more.
uint32_t counted_call_stack_size_bytes(void);

#endif
