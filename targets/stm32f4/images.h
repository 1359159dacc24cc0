/// The two places for an image on a board with boot code (boot.c), for the image that runs in one
/// of them: an update into the other one (image_service.h), and its own confirmation after one.
///
/// An image on trial confirms itself once it has run TRIAL_RUN_MS, no fault of the processor is
/// latched, and a host has asked for it over the bus, so that the next update has its way. Where
/// that has not come about after TRIAL_MOST_MS it restarts, which is the image before it.
#ifndef IMAGES_H
#define IMAGES_H

#include "image_place.h"
#include "image_service.h"
#include "nvm_stm32f4.h"
#include "slots.h"

#define TRIAL_RUN_MS 2000u
#define TRIAL_MOST_MS 60000u
#define RESTART_MS 200u ///< for the reply to leave

typedef struct {
    slots_t slots;
    hal_nvm_memory_t memory;
    image_store_t store;
    uint32_t running;    ///< slot; SLOT_NONE: this image has no boot code
    uint32_t written;    ///< words of the piece under way
    bool is_other_whole; ///< has an image for this board
    bool is_checking;    ///< the other one
    image_check_t check; ///< of it
    bool is_trial;
    bool was_asked; ///< for something, by a host
    bool restarts;
    uint32_t run_ms;
    uint32_t restart_ms; ///< left
} images_t;

/// What the image that runs knows of itself: image_info.h.
typedef struct {
    uint32_t begin; ///< its address
    uint32_t version;
    uint32_t mark; ///< first word of its seal
    const char *board;
} images_self_t;

/// self: kept by the caller. Looks at both places: some 0.1 s at 168 MHz where they are full.
void images_open(images_t *images, const images_self_t *self);

/// NULL where there is no other place.
const image_store_t *images_store(const images_t *images);

/// What a tick of passed_ms comes to. is_well: no fault of the processor is latched.
typedef enum { IMAGES_NOTHING, IMAGES_RESTART } images_wish_t;
images_wish_t images_tick(images_t *images, uint32_t passed_ms, bool is_well);

/// Which of the places are whole, for that board.
void images_look(bool is_whole[SLOTS], const char *board);

#endif
