/// Semihosting: how an image under the emulator prints a character and ends. A board without a
/// debugger faults on these calls; only tests, the fault report and the end of an image use them.
#ifndef SEMIHOST_H
#define SEMIHOST_H

#include <stdint.h>

void semihost_put_char(char c);
void semihost_put_text(const char *text);

/// value as eight hexadecimal digits.
void semihost_put_hex(uint32_t value);

/// Ends the emulator with this exit code (0 .. 255).
_Noreturn void semihost_exit(int code);

#endif
