/// What the law has learnt, as a table (table_file.h): taken out, put back, and when it is worth
/// writing. Memory wears, and what is learnt settles: it is written 1, 2, 4, .. minutes after the
/// start or the last write, once a day in the end, and only where it has changed.
#ifndef LEARNT_H
#define LEARNT_H

#include "table_file.h"

#ifdef __cplusplus
extern "C" {
#endif

#define LEARNT_LOOK_MS 1000u
#define LEARNT_FIRST_S 60u
#define LEARNT_SLOWEST_S 86400u
#define LEARNT_MOST_WORDS (3u + QUIESCE_LEARNT_MAX_WORDS)

typedef struct {
    uint32_t words[LEARNT_MOST_WORDS]; ///< [2] of them; 0: none
} learnt_t;

typedef struct {
    uint32_t passed_ms;
    uint32_t left_s; ///< until it is looked at again
    uint32_t pause_s;
    learnt_t kept;  ///< as it was stored, or is being
    learnt_t taken; ///< as it is sent to the host, or was before a restart
} learnt_store_t;

/// Nothing is known.
void learnt_init(learnt_store_t *self);

/// Takes it out of the law. Returns false, and leaves *self as it is, iff the law learns nothing.
/// Some 15,000 instructions.
bool learnt_take(learnt_t *self, const quiesce_t *controller);

/// Puts it back. Returns false, and changes nothing, iff it is none or does not belong here.
bool learnt_put(const uint32_t *words, uint32_t count, quiesce_t *controller);

/// Whether words are what was learnt, whoever by.
bool learnt_is_whole(const uint32_t *words, uint32_t count);

/// Time passes; returns true once in a second: learnt_is_due then. A few instructions, every tick.
static inline bool learnt_pass(learnt_store_t *self, uint32_t passed_ms) {
    self->passed_ms += passed_ms;
    return self->passed_ms >= LEARNT_LOOK_MS;
}

/// Returns true iff it is to be looked at now; false within the same second.
bool learnt_is_due(learnt_store_t *self);

/// It has been written, or begun to be: the next time is later.
void learnt_wrote(learnt_store_t *self);

/// CRC of it, 0: none.
static inline uint32_t learnt_crc(const learnt_t *self) {
    return self->words[2] > 0u ? self->words[1] : 0u;
}

#ifdef __cplusplus
}
#endif

#endif
