#include "image_peer.h"

#include <fcntl.h>
#include <stddef.h>
#include <sys/mman.h>
#include <unistd.h>

#include "image_info.h"

#define FLASH_BEGIN 0x08000000u
#define FLASH_WORDS 0x20000u
#define INFO_WITHIN 4096u
#define MOST_STARTS 3u

// hal/stm32f4/nvm_stm32f4.c has the same two places.
const nvm_stm32f4_area_t nvm_stm32f4_images = {
    .block_words = 0x7000u,
    .block = {{0x08004000u, 1, 4}, {0x08020000u, 5, 1}},
};

static uint32_t *flash;
static images_t images;
static images_self_t self;
static const char *name;
static unsigned bad_version;

// ---- flash --------------------------------------------------------------------------------------

static uint32_t *word_at(uint32_t at) {
    const uint32_t block_words = nvm_stm32f4_images.block_words;
    const uint32_t begin = nvm_stm32f4_images.block[at / block_words].begin;
    return &flash[(begin - FLASH_BEGIN) / 4u + at % block_words];
}

uint32_t hal_nvm_memory_words(const hal_nvm_memory_t *memory) {
    return 2u * memory->area->block_words;
}

uint32_t hal_nvm_memory_block_words(const hal_nvm_memory_t *memory) {
    return memory->area->block_words;
}

bool hal_nvm_memory_read(hal_nvm_memory_t *memory, uint32_t at, uint32_t *words, uint32_t count) {
    (void)memory;
    for (uint32_t i = 0; i < count; i++) {
        words[i] = *word_at(at + i);
    }
    return true;
}

hal_nvm_progress_t hal_nvm_memory_erase(hal_nvm_memory_t *memory, uint32_t at) {
    for (uint32_t i = 0; i < memory->area->block_words; i++) {
        *word_at(at + i) = UINT32_MAX;
    }
    return HAL_NVM_DONE;
}

hal_nvm_progress_t hal_nvm_memory_program(hal_nvm_memory_t *memory, uint32_t at,
                                          const uint32_t *words, uint32_t count) {
    (void)memory;
    for (uint32_t i = 0; i < count; i++) {
        *word_at(at + i) &= words[i];
    }
    return HAL_NVM_DONE;
}

static const uint8_t *bytes_at(uint32_t address) {
    return (const uint8_t *)flash + (address - FLASH_BEGIN);
}

const uint8_t *nvm_stm32f4_bytes(const nvm_stm32f4_area_t *area, uint32_t block) {
    return bytes_at(area->block[block].begin);
}

// ---- starts -------------------------------------------------------------------------------------

bool image_peer_open(const char *file, const char *board, unsigned bad) {
    const int fd = open(file, O_RDWR);
    name = board;
    bad_version = bad;
    void *const found =
        fd < 0 ? MAP_FAILED
               : mmap(NULL, 4u * FLASH_WORDS, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    flash = found == MAP_FAILED ? NULL : found;
    return flash != NULL && board != NULL;
}

// The slot that the boot code starts.
static uint32_t boot(void) {
    hal_nvm_memory_t memory = {.area = &nvm_stm32f4_images};
    slots_t slots;
    bool is_whole[SLOTS];
    slots_open(&slots, &memory);
    images_look(is_whole, name);
    return slots_start(&slots, is_whole);
}

// What the image in a slot says of itself: it is whole.
static void introduce(uint32_t slot) {
    const uint32_t begin = nvm_stm32f4_images.block[slot].begin;
    const uint32_t *info = (const uint32_t *)(const void *)bytes_at(begin);
    while (info[0] != IMAGE_INFO_MAGIC || info[1] != IMAGE_INFO_LAYOUT) {
        info++;
    }
    const uint32_t *const seal = (const uint32_t *)(const void *)bytes_at(info[5]);
    self = (images_self_t){.begin = begin, .version = info[2], .mark = seal[0], .board = name};
}

bool image_peer_start(node_t *node) {
    for (uint32_t i = 0; i < MOST_STARTS; i++) {
        const uint32_t slot = boot();
        if (slot == SLOT_NONE) {
            return false;
        }
        introduce(slot);
        if (bad_version == 0u || self.version != bad_version) {
            images_open(&images, &self);
            node_use_images(node, images_store(&images));
            node->images.is_held = images.is_trial;
            return true;
        }
    }
    return false;
}

bool image_peer_tick(node_t *node) {
    const bool restarts = images_tick(&images, 1, true) == IMAGES_RESTART;
    node->images.is_held = images.is_trial;
    return restarts;
}
