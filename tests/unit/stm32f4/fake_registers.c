#include "fake_registers.h"

#include "reg.h"

#include <stdio.h>
#include <string.h>

#define MOST_REGISTERS 256u
#define MOST_WRITES 65536u

static const struct {
    const fake_register_t *rows;
    const uint32_t *count;
} chips[FAKE_CHIPS] = {
    [FAKE_F405] = {stm32f405_registers, &stm32f405_count},
    [FAKE_F446] = {stm32f446_registers, &stm32f446_count},
};

static const fake_register_t *rows;
static uint32_t count;
static bool is_absent;
static uint32_t values[MOST_REGISTERS];
static uint32_t writes[MOST_REGISTERS];
static uint32_t written[MOST_WRITES];
static uint32_t all_writes;
static fake_hook_t *hook;
static bool is_in_hook;
static char mistake[128];
uint32_t fake_flash[FAKE_FLASH_WORDS];

static void note(const char *what, const char *name, uint32_t address, uint32_t value) {
    if (mistake[0] == '\0') {
        (void)snprintf(mistake, sizeof mistake, "%s: %s (%08x), %08x", what, name, address, value);
    }
}

// MOST_REGISTERS: there is none.
static uint32_t find(uint32_t address) {
    for (uint32_t i = 0; i < count; i++) {
        if (rows[i].address == address) {
            return i;
        }
    }
    note("no register", "?", address, 0);
    return MOST_REGISTERS;
}

void fake_reset(fake_chip_t chip) {
    rows = chips[chip].rows;
    count = *chips[chip].count;
    is_absent = false;
    all_writes = 0;
    hook = NULL;
    mistake[0] = '\0';
    for (uint32_t i = 0; i < count; i++) {
        values[i] = rows[i].reset;
        writes[i] = 0;
    }
}

void fake_absent(void) {
    is_absent = true;
}

void fake_use_hook(fake_hook_t *function) {
    hook = function;
}

static void call_hook(uint32_t address, bool is_write, uint32_t value) {
    if (hook != NULL && !is_in_hook) {
        is_in_hook = true;
        hook(address, is_write, value);
        is_in_hook = false;
    }
}

uint32_t fake_get(uint32_t address) {
    const uint32_t at = find(address);
    return at < count ? values[at] : 0u;
}

void fake_set(uint32_t address, uint32_t value) {
    const uint32_t at = find(address);
    if (at < count) {
        values[at] = value;
    }
}

const char *fake_mistake(void) {
    return mistake[0] == '\0' ? NULL : mistake;
}

uint32_t fake_writes(uint32_t address) {
    const uint32_t at = find(address);
    return at < count ? writes[at] : 0u;
}

uint32_t fake_all_writes(void) {
    return all_writes;
}

uint32_t fake_written_address(uint32_t n) {
    return n < all_writes ? written[n] : 0u;
}

static uint32_t takes(const fake_register_t *row) {
    return row->writable | row->clears_by_one | row->clears_by_zero | row->sets_by_one;
}

// Reserved bits read as they are.
static uint32_t write_only(const fake_register_t *row) {
    return takes(row) & ~row->readable;
}

static bool is_flash(uint32_t address) {
    return address - FAKE_FLASH_BASE < sizeof fake_flash;
}

uint32_t reg_read(uint32_t address) {
    if (is_absent) {
        return 0;
    }
    if (is_flash(address)) {
        return fake_flash[(address - FAKE_FLASH_BASE) / 4u];
    }
    call_hook(address, false, 0);
    const uint32_t at = find(address);
    return at < count ? values[at] & ~write_only(&rows[at]) : 0u;
}

static void take(uint32_t at, uint32_t value) {
    const fake_register_t *const row = &rows[at];
    if (takes(row) == 0u) {
        note("cannot be written", row->name, row->address, value);
    }
    if (((value ^ values[at]) & ~(takes(row) | row->readable)) != 0u) {
        note("reserved bits", row->name, row->address, value);
    }
    uint32_t next = (values[at] & ~row->writable) | (value & row->writable);
    next &= ~(value & row->clears_by_one);
    next &= ~(~value & row->clears_by_zero);
    values[at] = next | (value & row->sets_by_one);
}

void reg_write(uint32_t address, uint32_t value) {
    if (is_absent) {
        return;
    }
    const uint32_t at = is_flash(address) ? MOST_REGISTERS : find(address);
    if (at < count) {
        take(at, value);
        writes[at]++;
    }
    if (all_writes < MOST_WRITES) {
        written[all_writes++] = address;
    }
    call_hook(address, true, value);
}

const uint8_t *reg_bytes(uint32_t address) {
    return (const uint8_t *)fake_flash + (address - FAKE_FLASH_BASE);
}
