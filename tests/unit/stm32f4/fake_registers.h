/// Registers in the place of an STM32F4's: what hal/stm32f4/reg.h reads and writes on the host.
/// Reset values, what can be read and written and what a write clears come from the generated rows;
/// what else the hardware does (a clock that becomes ready, a byte that arrives) is a test's, by a
/// hook.
///
/// A read or write of what is no register, a write of what cannot be written and one of a reserved
/// bit that is not as it was are mistakes; a test asserts that there are none.
#ifndef FAKE_REGISTERS_H
#define FAKE_REGISTERS_H

#include <stdbool.h>
#include <stdint.h>

/// As generated/*.c have them.
typedef struct {
    const char *name;
    uint32_t address;
    uint32_t reset;
    uint32_t readable;
    uint32_t writable;
    uint32_t clears_by_one;
    uint32_t clears_by_zero;
    uint32_t sets_by_one; ///< until the hardware has done it
} fake_register_t;

extern const fake_register_t stm32f405_registers[];
extern const uint32_t stm32f405_count;
extern const fake_register_t stm32f446_registers[];
extern const uint32_t stm32f446_count;

typedef enum { FAKE_F405, FAKE_F446 } fake_chip_t;
#define FAKE_CHIPS 2u

/// Called before a read and after a write; value: what was written.
typedef void fake_hook_t(uint32_t address, bool is_write, uint32_t value);

/// All registers as after a reset; no hook; no mistakes; what was written is forgotten.
void fake_reset(fake_chip_t chip);

/// A chip without these registers, as QEMU's machine: reads are 0, writes are ignored.
void fake_absent(void);

void fake_use_hook(fake_hook_t *hook);

/// What the hardware sees and sets, whatever a program may.
uint32_t fake_get(uint32_t address);
void fake_set(uint32_t address, uint32_t value);

/// NULL where there was none, else the first one.
const char *fake_mistake(void);

/// Times that an address was written, and the value of the n-th write of all.
uint32_t fake_writes(uint32_t address);
uint32_t fake_all_writes(void);
uint32_t fake_written_address(uint32_t n);

/// All of the flash that parts of 512 KiB have; a write turns ones into zeros.
#define FAKE_FLASH_BASE 0x08000000u
#define FAKE_FLASH_WORDS 0x20000u
extern uint32_t fake_flash[FAKE_FLASH_WORDS];

#endif
