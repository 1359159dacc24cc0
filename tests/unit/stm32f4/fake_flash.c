#include "fake_flash.h"

#include <string.h>

#include "stm32f4_flash.h"
#include "unity.h"

#define KEYR (FLASH_BASE + FLASH_KEYR)
#define SR (FLASH_BASE + FLASH_SR)
#define CR (FLASH_BASE + FLASH_CR)

// RM0090 Rev 4, table 5.
const uint32_t fake_flash_sectors[FAKE_FLASH_SECTORS + 1u] = {
    0x08000000u, 0x08004000u, 0x08008000u, 0x0800C000u, 0x08010000u,
    0x08020000u, 0x08040000u, 0x08060000u, 0x08080000u};

fake_flash_state_t fake_flash_state;

void fake_flash_reset(uint32_t first_sector, uint32_t last_sector) {
    memset(fake_flash, 0, sizeof fake_flash);
    fake_flash_state = (fake_flash_state_t){
        .first_sector = first_sector,
        .last_sector = last_sector,
        .busy_reads = 3,
        .worn_word = UINT32_MAX,
    };
}

void fake_flash_assert_at_rest(void) {
    TEST_ASSERT_EQUAL_UINT32(0, fake_flash_state.unready);
    TEST_ASSERT_BITS_HIGH(FLASH_CR_LOCK, fake_get(CR));
}

static void erase(uint32_t cr) {
    fake_flash_state_t *const it = &fake_flash_state;
    const uint32_t sector = (cr & FLASH_CR_SNB) >> FLASH_CR_SNB_AT;
    TEST_ASSERT_EQUAL_UINT32(2u, (cr & FLASH_CR_PSIZE) >> FLASH_CR_PSIZE_AT);
    TEST_ASSERT_TRUE(sector >= it->first_sector && sector <= it->last_sector);
    TEST_ASSERT_BITS_HIGH(FLASH_CR_SER, cr);
    TEST_ASSERT_BITS_LOW(FLASH_CR_MER, cr);
    memset(&fake_flash[(fake_flash_sectors[sector] - FAKE_FLASH_BASE) / 4u], 0xFF,
           fake_flash_sectors[sector + 1u] - fake_flash_sectors[sector]);
    it->erased_sectors++;
    it->left = it->busy_reads;
    fake_set(CR, cr & ~FLASH_CR_STRT);
    fake_set(SR, FLASH_SR_BSY | it->error);
}

static void program(uint32_t at, uint32_t value) {
    fake_flash_state_t *const it = &fake_flash_state;
    const bool may = (fake_get(CR) & (FLASH_CR_PG | FLASH_CR_LOCK)) == FLASH_CR_PG;
    it->unready += may ? 0u : 1u;
    fake_flash[at] &= may && at != it->worn_word ? value : UINT32_MAX;
    fake_set(SR, fake_get(SR) | it->error);
}

// RM0090 Rev 4, page 67, and section 3.5.1: keys unlock, a write with PG programs, STRT with SER
// erases; BSY while it lasts.
void fake_flash_behave(uint32_t address, bool is_write, uint32_t value) {
    fake_flash_state_t *const it = &fake_flash_state;
    if (address == KEYR && is_write) {
        if (it->last_key == 0x45670123u && value == 0xCDEF89ABu) {
            fake_set(CR, fake_get(CR) & ~FLASH_CR_LOCK);
        }
        it->last_key = value;
    } else if (address == CR && is_write && (value & FLASH_CR_STRT) != 0u) {
        erase(value);
    } else if (address == SR && !is_write && (fake_get(SR) & FLASH_SR_BSY) != 0u) {
        it->left -= it->left > 0u ? 1u : 0u;
        fake_set(SR, it->left > 0u ? fake_get(SR) : fake_get(SR) & ~FLASH_SR_BSY);
    } else if (address - FAKE_FLASH_BASE < sizeof fake_flash && is_write) {
        program((address - FAKE_FLASH_BASE) / 4u, value);
    }
}
