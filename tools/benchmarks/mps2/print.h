/// How an image that measures itself says what it found.
#ifndef PRINT_H
#define PRINT_H

#include "semihost.h"

/// One line: name, blank, 0x and eight hexadecimal digits.
static inline void print(const char *name, uint32_t value) {
    semihost_put_text(name);
    semihost_put_text(" 0x");
    semihost_put_hex(value);
    semihost_put_char('\n');
}

#endif
