#include "nvm_stm32f4.h"

#include "reg.h"
#include "stm32f4_flash.h"

#define ACR (FLASH_BASE + FLASH_ACR)
#define SR (FLASH_BASE + FLASH_SR)
#define CR (FLASH_BASE + FLASH_CR)

#define KEY_1 0x45670123u
#define KEY_2 0xCDEF89ABu
#define BY_WORDS 2u // of PSIZE, for 2.7 .. 3.6 V
#define ERASED UINT32_MAX

/// A word takes 100 us at the most: more polls than that, at 168 MHz.
#define WORD_POLLS 20000u
#define ERASE_POLLS 1000000u
#define ERRORS                                                                                     \
    (FLASH_SR_OPERR | FLASH_SR_WRPERR | FLASH_SR_PGAERR | FLASH_SR_PGPERR | FLASH_SR_PGSERR)

const nvm_stm32f4_area_t nvm_stm32f4_records = {
    .block_words = 0x8000u,
    .block = {{0x08040000u, 6, 1}, {0x08060000u, 7, 1}},
};

// The second block is as large as the first; the rest of its sector stays empty.
const nvm_stm32f4_area_t nvm_stm32f4_images = {
    .block_words = 0x7000u,
    .block = {{0x08004000u, 1, 4}, {0x08020000u, 5, 1}},
};

const uint8_t *nvm_stm32f4_bytes(const nvm_stm32f4_area_t *area, uint32_t block) {
    return reg_bytes(area->block[block].begin);
}

uint32_t hal_nvm_memory_words(const hal_nvm_memory_t *memory) {
    return NVM_STM32F4_BLOCKS * memory->area->block_words;
}

uint32_t hal_nvm_memory_block_words(const hal_nvm_memory_t *memory) {
    return memory->area->block_words;
}

static bool is_inside(const hal_nvm_memory_t *memory, uint32_t at, uint32_t count) {
    const uint32_t words = hal_nvm_memory_words(memory);
    return at <= words && count <= words - at;
}

static uint32_t address_of(const hal_nvm_memory_t *memory, uint32_t at) {
    const uint32_t block_words = memory->area->block_words;
    return memory->area->block[at / block_words].begin + 4u * (at % block_words);
}

bool hal_nvm_memory_read(hal_nvm_memory_t *memory, uint32_t at, uint32_t *words, uint32_t count) {
    if (!is_inside(memory, at, count)) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        words[i] = reg_read(address_of(memory, at + i));
    }
    return true;
}

static bool unlock(void) {
    if ((reg_read(CR) & FLASH_CR_LOCK) != 0u) {
        reg_write(FLASH_BASE + FLASH_KEYR, KEY_1);
        reg_write(FLASH_BASE + FLASH_KEYR, KEY_2);
    }
    reg_write(SR, ERRORS | FLASH_SR_EOP); // of what was before
    return (reg_read(CR) & FLASH_CR_LOCK) == 0u && (reg_read(SR) & FLASH_SR_BSY) == 0u;
}

static void lock(void) {
    reg_write(CR, FLASH_CR_LOCK);
}

static bool has_failed(void) {
    return (reg_read(SR) & ERRORS) != 0u;
}

// The next sector of the block.
static bool begin_erasing(hal_nvm_memory_t *memory, uint32_t at) {
    const uint32_t block = at / memory->area->block_words;
    const uint32_t sector = memory->area->block[block].sector + memory->erased_sectors;
    memory->polls = 0;
    if (!unlock()) {
        return false;
    }
    const uint32_t word = BY_WORDS << FLASH_CR_PSIZE_AT | sector << FLASH_CR_SNB_AT | FLASH_CR_SER;
    reg_write(CR, word);
    reg_write(CR, word | FLASH_CR_STRT);
    return true;
}

// What the cache had of the sector is no longer true.
static void forget_cached(void) {
    reg_clear(ACR, FLASH_ACR_DCEN);
    reg_set(ACR, FLASH_ACR_DCRST);
    reg_clear(ACR, FLASH_ACR_DCRST);
    reg_set(ACR, FLASH_ACR_DCEN);
}

static hal_nvm_progress_t end(hal_nvm_memory_t *memory, hal_nvm_progress_t progress) {
    memory->phase = NVM_STM32F4_IDLE;
    lock();
    return progress;
}

static hal_nvm_progress_t begin_sector(hal_nvm_memory_t *memory, uint32_t at) {
    memory->phase = NVM_STM32F4_ERASES;
    return begin_erasing(memory, at) ? HAL_NVM_BUSY : end(memory, HAL_NVM_FAILED);
}

// Each sector waits for leave of its own: the image has fed its watchdog in between.
static hal_nvm_progress_t wait_for_end(hal_nvm_memory_t *memory, uint32_t at) {
    const uint32_t sectors = memory->area->block[at / memory->area->block_words].sectors;
    if ((reg_read(SR) & FLASH_SR_BSY) != 0u) {
        memory->polls++;
        return memory->polls < ERASE_POLLS ? HAL_NVM_BUSY : end(memory, HAL_NVM_FAILED);
    }
    forget_cached();
    if (has_failed()) {
        return end(memory, HAL_NVM_FAILED);
    }
    memory->erased_sectors++;
    memory->phase = memory->erased_sectors < sectors ? NVM_STM32F4_WAITS : NVM_STM32F4_LOOKS;
    memory->looked_words = 0;
    return HAL_NVM_BUSY;
}

static hal_nvm_progress_t look(hal_nvm_memory_t *memory, uint32_t at) {
    for (uint32_t i = 0; i < NVM_STM32F4_LOOK_WORDS; i++) {
        if (reg_read(address_of(memory, at + memory->looked_words + i)) != ERASED) {
            return end(memory, HAL_NVM_FAILED);
        }
    }
    memory->looked_words += NVM_STM32F4_LOOK_WORDS;
    return memory->looked_words < memory->area->block_words ? HAL_NVM_BUSY
                                                            : end(memory, HAL_NVM_DONE);
}

hal_nvm_progress_t hal_nvm_memory_erase(hal_nvm_memory_t *memory, uint32_t at) {
    if (at % memory->area->block_words != 0u || !is_inside(memory, at, memory->area->block_words)) {
        return HAL_NVM_FAILED;
    }
    switch (memory->phase) {
    case NVM_STM32F4_ERASES:
        return wait_for_end(memory, at);
    case NVM_STM32F4_LOOKS:
        return look(memory, at);
    case NVM_STM32F4_IDLE:
        memory->erased_sectors = 0;
        memory->phase = NVM_STM32F4_WAITS;
        return memory->may_erase ? begin_sector(memory, at) : HAL_NVM_BUSY;
    case NVM_STM32F4_WAITS:
    default:
        return memory->may_erase ? begin_sector(memory, at) : HAL_NVM_BUSY;
    }
}

static bool program_word(uint32_t address, uint32_t word) {
    reg_write(address, word);
    return reg_wait(SR, FLASH_SR_BSY, 0, WORD_POLLS) && !has_failed() && reg_read(address) == word;
}

hal_nvm_progress_t hal_nvm_memory_program(hal_nvm_memory_t *memory, uint32_t at,
                                          const uint32_t *words, uint32_t count) {
    if (count > HAL_NVM_SLICE_WORDS || !is_inside(memory, at, count)) {
        return HAL_NVM_FAILED;
    }
    for (uint32_t i = 0; i < count; i++) {
        if ((reg_read(address_of(memory, at + i)) & words[i]) != words[i]) {
            return HAL_NVM_FAILED;
        }
    }
    bool is_programmed = unlock();
    if (is_programmed) {
        reg_write(CR, BY_WORDS << FLASH_CR_PSIZE_AT | FLASH_CR_PG);
    }
    for (uint32_t i = 0; is_programmed && i < count; i++) {
        is_programmed = program_word(address_of(memory, at + i), words[i]);
    }
    lock();
    return is_programmed ? HAL_NVM_DONE : HAL_NVM_FAILED;
}
