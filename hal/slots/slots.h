/// Two places in flash for an image, and which of them runs after a reset: what an update over the
/// bus writes while the other one runs, tries once, and goes back from unless it is confirmed.
///
/// A slot is a block of a hal/nvm_memory.h of two: the image first, marks in its last words. A mark
/// is a word that is programmed from all ones to 0; only an erasure takes it back. What a power cut
/// leaves of one may read otherwise at each start: the image that was started programs again what
/// it was chosen by, and rejects the other one for good where that was neither finished nor
/// confirmed (slots_settle). An image that a debugger has written has no mark, and is as good as a
/// confirmed one.
#ifndef SLOTS_H
#define SLOTS_H

#include "hal/nvm_memory.h"

#define SLOTS 2u
#define SLOT_NONE SLOTS
#define SLOT_MARK_WORDS 32u ///< at the end of a slot

/// By how much they are wanted. The first three never run.
typedef enum {
    SLOT_EMPTY,    ///< no whole image
    SLOT_INCOMING, ///< being written, or the rest of that
    SLOT_REJECTED, ///< tried without success, or given up
    SLOT_SUPERSEDED,
    SLOT_GOOD,  ///< confirmed, or written by a debugger
    SLOT_TRIAL, ///< to be run once
} slot_state_t;

typedef struct {
    hal_nvm_memory_t *memory;
    bool is_erasing;
} slots_t;

/// memory: the caller's, of two blocks and nothing else.
void slots_open(slots_t *self, hal_nvm_memory_t *memory);

/// Of a slot for the image alone, in words.
uint32_t slots_room(const slots_t *self);

/// is_whole: of the image in it, as the caller has found.
slot_state_t slots_state(const slots_t *self, uint32_t slot, bool is_whole);

/// The slot to be run, SLOT_NONE where there is none. What is run on trial is marked so first, and
/// not run where that fails.
uint32_t slots_start(const slots_t *self, const bool is_whole[SLOTS]);

/// By the image that runs, once after its start: later starts find what this one has found. Returns
/// false iff the flash refuses.
bool slots_settle(const slots_t *self, uint32_t running, const bool is_whole[SLOTS]);

/// The image that runs is on trial: unless it confirms itself the next start is the other one's.
bool slots_is_trial(const slots_t *self, uint32_t running);

/// The image that runs has shown that it works. Returns false iff the flash refuses, or it was
/// rejected before.
bool slots_confirm(const slots_t *self, uint32_t running);

/// Makes room in a slot that does not run. Call it until it is not BUSY; nothing else meanwhile.
hal_nvm_progress_t slots_prepare(slots_t *self, uint32_t slot);

/// Part of an image into a slot that is prepared: at a multiple of 4, count at most
/// HAL_NVM_SLICE_WORDS. Returns BUSY, DONE, or FAILED, also where it would leave the room.
hal_nvm_progress_t slots_write(const slots_t *self, uint32_t slot, uint32_t at,
                               const uint32_t *words, uint32_t count);

/// A slot that is prepared and written has a whole image: it is tried at the next start. Returns
/// false iff the flash refuses.
bool slots_finish(const slots_t *self, uint32_t slot);

#endif
