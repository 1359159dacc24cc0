/// Access to a register by its address: in an image a load or a store, on the host what a test's
/// fakes do (tests/unit/stm32f4/fake_registers.h). Words only.
#ifndef REG_H
#define REG_H

#include <stdbool.h>
#include <stdint.h>

#ifdef QUIESCE_TARGET_IMAGE
static inline uint32_t reg_read(uint32_t address) {
    return *(const volatile uint32_t *)(uintptr_t)address;
}

static inline void reg_write(uint32_t address, uint32_t value) {
    *(volatile uint32_t *)(uintptr_t)address = value;
}
/// Flash from there on, to be read only.
static inline const uint8_t *reg_bytes(uint32_t address) {
    return (const uint8_t *)(uintptr_t)address;
}
#else
uint32_t reg_read(uint32_t address);
void reg_write(uint32_t address, uint32_t value);
const uint8_t *reg_bytes(uint32_t address);
#endif

/// Writes the bits of mask, keeps the others. Not for flags that a write clears.
static inline void reg_change(uint32_t address, uint32_t mask, uint32_t bits) {
    reg_write(address, (reg_read(address) & ~mask) | bits);
}

static inline void reg_set(uint32_t address, uint32_t bits) {
    reg_change(address, 0, bits);
}

static inline void reg_clear(uint32_t address, uint32_t bits) {
    reg_change(address, bits, 0);
}

/// Reads until the bits of mask are what they are to be, polls times at the most; a register that
/// is not there cannot hang its caller. Returns whether they are.
static inline bool reg_wait(uint32_t address, uint32_t mask, uint32_t bits, uint32_t polls) {
    for (uint32_t i = 0; i < polls; i++) {
        if ((reg_read(address) & mask) == bits) {
            return true;
        }
    }
    return false;
}

#endif
