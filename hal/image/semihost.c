#include "semihost.h"

// Operation numbers of Arm's semihosting specification (version 2.0).
#define SYS_WRITEC 0x03u
#define SYS_WRITE0 0x04u
#define SYS_EXIT_EXTENDED 0x20u
#define ADP_STOPPED_APPLICATION_EXIT 0x20026u

void semihost_put_char(char c) {
    semihost_trap(SYS_WRITEC, &c);
}

void semihost_put_text(const char *text) {
    semihost_trap(SYS_WRITE0, text);
}

void semihost_put_hex(uint32_t value) {
    for (int shift = 28; shift >= 0; shift -= 4) {
        semihost_put_char("0123456789abcdef"[(value >> shift) & 15u]);
    }
}

_Noreturn void semihost_exit(int code) {
    const uint32_t block[2] = {ADP_STOPPED_APPLICATION_EXIT, (uint32_t)code};
    for (;;) {
        semihost_trap(SYS_EXIT_EXTENDED, block);
    }
}
