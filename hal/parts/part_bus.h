/// How a sensor is reached: one SPI transfer at a time. A board's driver provides it.
#ifndef PART_BUS_H
#define PART_BUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Sends and receives bytes at once, with chip select low throughout.
typedef struct {
    bool (*exchange)(void *context, const uint8_t *out, uint8_t *in, size_t bytes);
    void (*pause_ms)(void *context, uint32_t ms); ///< at the start only
    void *context;
} part_bus_t;

/// What a start has found.
typedef enum {
    PART_WELL = 0,
    PART_NO_TRANSFER,
    PART_NOT_THERE,  ///< bytes: its ids
    PART_NO_RESET,   ///< it does not come back as it was
    PART_NOT_STORED, ///< bytes: register, what was written, what it reads
    PART_NO_RANGE,   ///< the part has none such
    PART_NO_RATE,
} part_verdict_t;

#define PART_BYTES 3u

typedef struct {
    part_verdict_t verdict;
    uint8_t bytes[PART_BYTES];
} part_problem_t;

#endif
