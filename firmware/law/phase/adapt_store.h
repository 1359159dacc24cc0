/// What has been learnt as 32-bit words, to keep over a restart: magic and version, CRC-32 of all
/// words after it, CRC of the pulse table and setting that it belongs to, then the trims.
#ifndef ADAPT_STORE_H
#define ADAPT_STORE_H

#include "adapt.h"

#define ADAPT_STORE_MAGIC UINT32_C(0x31444151)
#define ADAPT_STORE_WORDS (4u + ADAPT_POINTS * 2u)

/// Which pulses trims belong to.
typedef struct {
    uint32_t table_crc;
    uint32_t setting;
} adapt_owner_t;

/// Writes all ADAPT_STORE_WORDS.
void adapt_store(const adapt_t *self, adapt_owner_t owner, uint32_t *words);

/// Takes trims over. Returns false, and changes nothing, iff the words are damaged, of another
/// version or another owner, or a trim is beyond self's limits.
bool adapt_restore(adapt_t *self, adapt_owner_t owner, const uint32_t *words);

#endif
