/// Where in a controller's words the records lie that decide about the output.
#ifndef RECORDS_H
#define RECORDS_H

#include "quiesce.h"

typedef struct {
    const char *name;
    uint32_t offset; ///< of its first byte
    uint32_t bytes;
} record_t;

enum { MOST_RECORDS = 1 + QUIESCE_DAMPERS };

/// Writes those of a controller with so many dampers. Returns their number.
uint32_t records_of(uint32_t dampers, record_t records[MOST_RECORDS]);

#endif
