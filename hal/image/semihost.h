/// Semihosting: how an image under the emulator prints a character and ends. A board without a
/// debugger faults on these calls; only tests, the fault report and the end of an image use them.
#ifndef SEMIHOST_H
#define SEMIHOST_H

#include <stdint.h>

/// The processor's instruction for it: each start-up (hal/mps2, hal/riscv_virt) has its own.
/// operation: a number of Arm's semihosting specification; argument: what that takes.
void semihost_trap(uint32_t operation, const void *argument);

void semihost_put_char(char c);
void semihost_put_text(const char *text);

/// value as eight hexadecimal digits.
void semihost_put_hex(uint32_t value);

/// Ends the emulator with this exit code (0 .. 255).
_Noreturn void semihost_exit(int code);

#endif
