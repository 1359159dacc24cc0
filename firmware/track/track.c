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
