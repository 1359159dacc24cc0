// The controller itself, for what no header says of it: where its records are. It takes the place
// of the library's.
#include "controller.c" // NOLINT(bugprone-suspicious-include)

#include "records.h"

static record_t at(const char *name, size_t offset, size_t end) {
    return (record_t){.name = name, .offset = (uint32_t)offset, .bytes = (uint32_t)(end - offset)};
}

#define END_OF(type, field) (offsetof(type, field) + sizeof(((type *)0)->field))

// Each with its twin, which follows it.
uint32_t records_of(uint32_t dampers, record_t records[MOST_RECORDS]) {
    uint32_t count = 0;
    records[count++] =
        at("supervisor", offsetof(controller_t, supervisor), END_OF(controller_t, supervisor_twin));
    for (uint32_t i = 0; i < dampers; i++) {
        const size_t drive = offsetof(controller_t, drive) + i * sizeof(drive_t);
        records[count++] =
            at("limits", drive + offsetof(drive_t, limits), drive + END_OF(drive_t, twin));
    }
    return count;
}
