#include "slots.h"

#define MARK_GAP 4u ///< words from one mark to the next: what is programmed at once
#define MARK_POLLS 1000u
#define ERASED UINT32_MAX

/// In the order of an update.
typedef enum {
    MARK_INCOMING,
    MARK_READY,
    MARK_TRIED,
    MARK_SUPERSEDED,
    MARK_CONFIRMED,
    MARK_REJECTED,
} mark_t;

void slots_open(slots_t *self, hal_nvm_memory_t *memory) {
    self->memory = memory;
    self->is_erasing = false;
}

uint32_t slots_room(const slots_t *self) {
    return hal_nvm_memory_block_words(self->memory) - SLOT_MARK_WORDS;
}

static uint32_t begin_of(const slots_t *self, uint32_t slot) {
    return slot * hal_nvm_memory_block_words(self->memory);
}

static uint32_t place_of(const slots_t *self, uint32_t slot, mark_t mark) {
    return begin_of(self, slot) + slots_room(self) + MARK_GAP * (uint32_t)mark;
}

// Where it cannot be read there is none.
static uint32_t word_of(const slots_t *self, uint32_t slot, mark_t mark) {
    uint32_t word = ERASED;
    return hal_nvm_memory_read(self->memory, place_of(self, slot, mark), &word, 1u) ? word : ERASED;
}

// All of it is programmed: what allows an image to run.
static bool is_marked(const slots_t *self, uint32_t slot, mark_t mark) {
    return word_of(self, slot, mark) == 0u;
}

// Some of it is: what keeps one from running.
static bool is_touched(const slots_t *self, uint32_t slot, mark_t mark) {
    return word_of(self, slot, mark) != ERASED;
}

static bool put_mark(const slots_t *self, uint32_t slot, mark_t mark) {
    const uint32_t zero = 0;
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < MARK_POLLS && progress == HAL_NVM_BUSY; i++) {
        progress = hal_nvm_memory_program(self->memory, place_of(self, slot, mark), &zero, 1u);
    }
    return progress == HAL_NVM_DONE && is_marked(self, slot, mark);
}

slot_state_t slots_state(const slots_t *self, uint32_t slot, bool is_whole) {
    const bool is_by_bus = is_touched(self, slot, MARK_INCOMING);
    if (!is_whole) {
        return SLOT_EMPTY;
    }
    if (is_touched(self, slot, MARK_REJECTED)) {
        return SLOT_REJECTED;
    }
    if (is_by_bus && !is_marked(self, slot, MARK_READY)) {
        return SLOT_INCOMING;
    }
    if (is_by_bus && !is_marked(self, slot, MARK_CONFIRMED)) {
        return is_touched(self, slot, MARK_TRIED) ? SLOT_REJECTED : SLOT_TRIAL;
    }
    return is_touched(self, slot, MARK_SUPERSEDED) ? SLOT_SUPERSEDED : SLOT_GOOD;
}

// The first of those that are wanted most: of two good ones a debugger has written the first.
static uint32_t most_wanted(const slot_state_t state[SLOTS]) {
    const uint32_t slot = state[1] > state[0] ? 1u : 0u;
    return state[slot] >= SLOT_SUPERSEDED ? slot : SLOT_NONE;
}

uint32_t slots_start(const slots_t *self, const bool is_whole[SLOTS]) {
    slot_state_t state[SLOTS];
    for (uint32_t i = 0; i < SLOTS; i++) {
        state[i] = slots_state(self, i, is_whole[i]);
    }
    for (uint32_t i = 0; i < SLOTS; i++) {
        const uint32_t slot = most_wanted(state);
        if (slot == SLOT_NONE || state[slot] != SLOT_TRIAL || put_mark(self, slot, MARK_TRIED)) {
            return slot;
        }
        state[slot] = SLOT_REJECTED;
    }
    return SLOT_NONE;
}

bool slots_is_trial(const slots_t *self, uint32_t running) {
    return is_touched(self, running, MARK_INCOMING) && !is_marked(self, running, MARK_CONFIRMED);
}

static bool settle_other(const slots_t *self, uint32_t other, bool is_whole) {
    switch (slots_state(self, other, is_whole)) {
    case SLOT_INCOMING:
    case SLOT_REJECTED:
    case SLOT_TRIAL:
        return put_mark(self, other, MARK_REJECTED);
    case SLOT_GOOD:
        return put_mark(self, other, MARK_SUPERSEDED);
    case SLOT_EMPTY:
    case SLOT_SUPERSEDED:
    default:
        return true;
    }
}

bool slots_settle(const slots_t *self, uint32_t running, const bool is_whole[SLOTS]) {
    const uint32_t other = 1u - running;
    if (slots_is_trial(self, running)) {
        return true; // the other one has to be there where this one fails
    }
    const bool is_kept =
        !is_touched(self, running, MARK_INCOMING) ||
        (put_mark(self, running, MARK_READY) && put_mark(self, running, MARK_CONFIRMED));
    return settle_other(self, other, is_whole[other]) && is_kept;
}

bool slots_confirm(const slots_t *self, uint32_t running) {
    // In this order: a cut between the two leaves the other one.
    return !is_touched(self, running, MARK_REJECTED) &&
           put_mark(self, 1u - running, MARK_SUPERSEDED) && put_mark(self, running, MARK_CONFIRMED);
}

static hal_nvm_progress_t end(slots_t *self, bool is_good) {
    self->is_erasing = false;
    return is_good ? HAL_NVM_DONE : HAL_NVM_FAILED;
}

hal_nvm_progress_t slots_prepare(slots_t *self, uint32_t slot) {
    // Half an erasure must not bring back what was there.
    if (!self->is_erasing && !put_mark(self, slot, MARK_REJECTED)) {
        return HAL_NVM_FAILED;
    }
    self->is_erasing = true;
    const hal_nvm_progress_t progress = hal_nvm_memory_erase(self->memory, begin_of(self, slot));
    if (progress == HAL_NVM_BUSY) {
        return HAL_NVM_BUSY;
    }
    return end(self, progress == HAL_NVM_DONE && put_mark(self, slot, MARK_INCOMING));
}

hal_nvm_progress_t slots_write(const slots_t *self, uint32_t slot, uint32_t at,
                               const uint32_t *words, uint32_t count) {
    const uint32_t room = slots_room(self);
    if (at % MARK_GAP != 0u || at > room || count > room - at) {
        return HAL_NVM_FAILED;
    }
    return hal_nvm_memory_program(self->memory, begin_of(self, slot) + at, words, count);
}

bool slots_finish(const slots_t *self, uint32_t slot) {
    return is_marked(self, slot, MARK_INCOMING) && put_mark(self, slot, MARK_READY);
}
