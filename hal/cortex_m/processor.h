/// Leaving a program for another one.
#ifndef PROCESSOR_H
#define PROCESSOR_H

#include <stdint.h>

/// Everything from the beginning, as at power-up, but for RAM.
_Noreturn void processor_reset(void);

/// Runs the image whose vectors lie there, with interrupts as after a reset: none may be enabled.
_Noreturn void processor_run(uint32_t vectors);

#endif
