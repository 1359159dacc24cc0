#include "track.h"

#include <stddef.h>

#define DECLARE(number, name) extern const track_t track_##name;
#define ENTRY(number, name) [QUIESCE_TRACKER_##number] = &track_##name,

QUIESCE_EACH_TRACKER(DECLARE)

static const track_t *const trackers[] = {QUIESCE_EACH_TRACKER(ENTRY)};

const track_t *track_find(int32_t index) {
    const int32_t count = (int32_t)(sizeof trackers / sizeof trackers[0]);
    return index >= 0 && index < count ? trackers[index] : NULL;
}

quiesce_table_verdict_t quiesce_tracker_table_check(const uint32_t *words, uint32_t count) {
    for (int32_t i = 0; track_find(i) != NULL; i++) {
        const track_table_kind_t *kind = track_find(i)->kind;
        if (kind != NULL && count > 0 && words[0] == kind->magic) {
            return kind->check(words, count);
        }
    }
    return QUIESCE_TABLE_MAGIC;
}
