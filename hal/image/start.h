/// From reset to main, once the processor has a stack: what every image has in common.
#ifndef START_H
#define START_H

/// Paints the stack (stack.h), copies .data, clears .bss, calls main and ends the emulator with its
/// result. For the port's Reset_Handler, which calls it first of all.
_Noreturn void start_image(void);

#endif
