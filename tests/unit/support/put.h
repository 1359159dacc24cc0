/// Text from a program that also runs where there is no stdio: an image prints by semihosting.
#ifndef PUT_H
#define PUT_H

#include <stdint.h>

#ifdef QUIESCE_TARGET_IMAGE
#include "semihost.h"
#else
#include <stdio.h>
#endif

static inline void put_char(char c) {
#ifdef QUIESCE_TARGET_IMAGE
    semihost_put_char(c);
#else
    (void)putchar(c);
#endif
}

static inline void put_text(const char *text) {
    for (; *text != '\0'; text++) {
        put_char(*text);
    }
}

/// Eight hexadecimal digits, upper case.
static inline void put_hex(uint32_t value) {
    for (uint32_t shift = 32; shift > 0; shift -= 4) {
        put_char("0123456789ABCDEF"[(value >> (shift - 4u)) & 15u]);
    }
}

#endif
