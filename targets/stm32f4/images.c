#include "images.h"

#include <stddef.h>

#include "crc32.h"

#define WORD_BYTES 4u
#define NAME_WORDS 8u    ///< of a board's name that its CRC is of
#define BLOCKS_A_TICK 2u ///< some 9,000 instructions

static const images_self_t *own;

static uint32_t room_bytes(void) {
    return WORD_BYTES * (nvm_stm32f4_images.block_words - SLOT_MARK_WORDS);
}

static image_place_t place_of(uint32_t slot) {
    return (image_place_t){nvm_stm32f4_bytes(&nvm_stm32f4_images, slot), room_bytes(),
                           nvm_stm32f4_images.block[slot].begin};
}

void images_look(bool is_whole[SLOTS], const char *board) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        const image_place_t place = place_of(i);
        is_whole[i] = image_is_in(&place, board);
    }
}

static uint32_t slot_at(uint32_t begin) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        if (nvm_stm32f4_images.block[i].begin == begin) {
            return i;
        }
    }
    return SLOT_NONE;
}

static uint32_t other(const images_t *images) {
    return 1u - images->running;
}

// ---- the store ----------------------------------------------------------------------------------

static image_store_answer_t answer_of(hal_nvm_progress_t progress) {
    switch (progress) {
    case HAL_NVM_DONE:
        return IMAGE_STORE_DONE;
    case HAL_NVM_BUSY:
        return IMAGE_STORE_BUSY;
    case HAL_NVM_FAILED:
    default:
        return IMAGE_STORE_FAILED;
    }
}

static image_store_answer_t prepare(void *context) {
    images_t *const images = context;
    if (images->is_trial) {
        return IMAGE_STORE_REFUSED; // the other one has to be there
    }
    images->written = 0;
    images->is_other_whole = false;
    images->is_checking = false;
    return answer_of(slots_prepare(&images->slots, other(images)));
}

// A slice a tick.
static image_store_answer_t write(void *context, uint32_t at, const uint32_t *words,
                                  uint32_t count) {
    images_t *const images = context;
    const uint32_t left = count - images->written;
    const uint32_t slice = left < HAL_NVM_SLICE_WORDS ? left : HAL_NVM_SLICE_WORDS;
    const hal_nvm_progress_t progress = slots_write(
        &images->slots, other(images), at + images->written, &words[images->written], slice);
    images->written += progress == HAL_NVM_DONE ? slice : 0u;
    if (progress == HAL_NVM_BUSY || (progress == HAL_NVM_DONE && images->written < count)) {
        return IMAGE_STORE_BUSY;
    }
    images->written = 0;
    return answer_of(progress);
}

// A slice of its sum a tick.
static image_store_answer_t finish(void *context) {
    images_t *const images = context;
    if (!images->is_checking) {
        const image_place_t place = place_of(other(images));
        image_check_begin(&images->check, &place, own->board);
        images->is_checking = true;
    }
    const image_check_result_t result = image_check_work(&images->check, BLOCKS_A_TICK);
    if (result == IMAGE_CHECK_BUSY) {
        return IMAGE_STORE_BUSY;
    }
    images->is_checking = false;
    images->is_other_whole = result == IMAGE_CHECK_GOOD;
    if (!images->is_other_whole) {
        return IMAGE_STORE_REFUSED;
    }
    return slots_finish(&images->slots, other(images)) ? IMAGE_STORE_DONE : IMAGE_STORE_FAILED;
}

static uint32_t crc_of_name(const char *name) {
    uint32_t words[NAME_WORDS] = {0};
    for (uint32_t i = 0; i < WORD_BYTES * NAME_WORDS && name[i] != '\0'; i++) {
        words[i / WORD_BYTES] |= (uint32_t)(uint8_t)name[i] << (8u * (i % WORD_BYTES));
    }
    return crc32_words(words, NAME_WORDS);
}

static uint32_t tell(void *context, image_info_number_t what) {
    images_t *const images = context;
    images->was_asked = true;
    switch (what) {
    case IMAGE_INFO_VERSION:
        return own->version;
    case IMAGE_INFO_SLOT:
        return images->running;
    case IMAGE_INFO_MARK:
        return own->mark;
    case IMAGE_INFO_IS_TRIAL:
        return images->is_trial ? 1u : 0u;
    case IMAGE_INFO_OTHER:
        return (uint32_t)slots_state(&images->slots, other(images), images->is_other_whole);
    case IMAGE_INFO_BEGIN:
        return nvm_stm32f4_images.block[other(images)].begin;
    case IMAGE_INFO_ROOM:
        return room_bytes();
    case IMAGE_INFO_BOARD:
        return crc_of_name(own->board);
    case IMAGE_INFO_WORDS: // the service's
    case IMAGE_INFOS:
    default:
        return 0;
    }
}

static void start(void *context) {
    images_t *const images = context;
    images->restarts = true;
    images->restart_ms = RESTART_MS;
}

// ---- the image that runs ------------------------------------------------------------------------

void images_open(images_t *images, const images_self_t *self) {
    bool is_whole[SLOTS];
    own = self;
    *images = (images_t){.memory = {.area = &nvm_stm32f4_images}, .running = slot_at(self->begin)};
    slots_open(&images->slots, &images->memory);
    if (images->running == SLOT_NONE) {
        return;
    }
    images_look(is_whole, self->board);
    images->is_other_whole = is_whole[other(images)];
    (void)slots_settle(&images->slots, images->running, is_whole);
    images->is_trial = slots_is_trial(&images->slots, images->running);
    images->store = (image_store_t){images, prepare, write, finish, tell, start};
}

const image_store_t *images_store(const images_t *images) {
    return images->running == SLOT_NONE ? NULL : &images->store;
}

static void try_to_confirm(images_t *images, bool is_well) {
    if (is_well && images->was_asked && images->run_ms >= TRIAL_RUN_MS) {
        images->is_trial = !slots_confirm(&images->slots, images->running);
    }
    images->restarts = images->is_trial && images->run_ms >= TRIAL_MOST_MS;
}

images_wish_t images_tick(images_t *images, uint32_t passed_ms, bool is_well) {
    images->run_ms += passed_ms;
    if (images->is_trial) {
        try_to_confirm(images, is_well);
    }
    images->restart_ms -= passed_ms < images->restart_ms ? passed_ms : images->restart_ms;
    return images->restarts && images->restart_ms == 0u ? IMAGES_RESTART : IMAGES_NOTHING;
}
