// Kinds of tables are those of the laws and trackers.
#include "quiesce.h"

#include <stddef.h>

#include "law.h"
#include "track.h"

static const table_kind_t *find(uint32_t magic, quiesce_owner_t *owner) {
    for (int32_t i = 0; i < QUIESCE_LAW_COUNT; i++) {
        const table_kind_t *kind = law_find(i) != NULL ? law_find(i)->kind : NULL;
        if (kind != NULL && kind->magic == magic) {
            *owner = QUIESCE_OF_LAW;
            return kind;
        }
    }
    for (int32_t i = 0; i < QUIESCE_TRACKER_COUNT; i++) {
        const table_kind_t *kind = track_find(i) != NULL ? track_find(i)->kind : NULL;
        if (kind != NULL && kind->magic == magic) {
            *owner = QUIESCE_OF_TRACKER;
            return kind;
        }
    }
    return NULL;
}

const char *quiesce_table_kind(uint32_t magic, quiesce_owner_t *owner) {
    quiesce_owner_t found;
    const table_kind_t *kind = find(magic, owner != NULL ? owner : &found);
    return kind != NULL ? kind->name : NULL;
}

quiesce_table_verdict_t quiesce_table_check(const uint32_t *words, uint32_t count) {
    quiesce_owner_t owner;
    const table_kind_t *kind = count > 0 ? find(words[TABLE_MAGIC], &owner) : NULL;
    if (kind == NULL) {
        return count > 0 ? QUIESCE_TABLE_MAGIC : QUIESCE_TABLE_SIZE;
    }
    return table_check(kind, words, count);
}
