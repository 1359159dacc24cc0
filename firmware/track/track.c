#include "track.h"

#include <stddef.h>

#define DECLARE(number, name) extern const track_t track_##name;
#define ENTRY(number, name)                                                                        \
    [QUIESCE_TRACKER_##number] = QUIESCE_WITH_TRACKER_##number ? &track_##name : NULL,

QUIESCE_EACH_TRACKER(DECLARE)

static const track_t *const trackers[QUIESCE_TRACKER_COUNT] = {QUIESCE_EACH_TRACKER(ENTRY)};

const track_t *track_find(int32_t index) {
    return index >= 0 && index < QUIESCE_TRACKER_COUNT ? trackers[index] : NULL;
}
