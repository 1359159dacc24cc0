// The controller itself, for what no header says of it: where its records are. It takes the place
// of the library's.
#include "controller.c" // NOLINT(bugprone-suspicious-include)

#include "records.h"

static record_t at(const char *name, size_t offset, size_t bytes) {
    return (record_t){.name = name, .offset = (uint32_t)offset, .bytes = (uint32_t)bytes};
}

uint32_t records_of(uint32_t dampers, record_t records[MOST_RECORDS]) {
    uint32_t count = 0;
    records[count++] = at("supervisor", offsetof(controller_t, supervisor), sizeof(supervisor_t));
    for (uint32_t i = 0; i < dampers; i++) {
        const size_t drive = offsetof(controller_t, drive) + i * sizeof(drive_t);
        records[count++] = at("guard", drive + offsetof(drive_t, guard), sizeof(guard_t));
        records[count++] = at("ceiling", drive + offsetof(drive_t, ceiling_mA), sizeof(int32_t));
    }
    return count;
}
