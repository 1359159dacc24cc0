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

#define PART_MOST_READ 15u

/// Bytes behind a command byte, which says where they begin and that they are read. count: at most
/// PART_MOST_READ. False where the transfer fails.
bool part_read(const part_bus_t *bus, uint8_t command, uint8_t *out, size_t count);

bool part_write(const part_bus_t *bus, uint8_t command, uint8_t value);

/// A register of a part: its address, and the command bytes that read and write it.
typedef struct {
    uint8_t address;
    uint8_t read;
    uint8_t write;
} part_register_t;

/// Writes it and reads it back. False with PART_NO_TRANSFER or PART_NOT_STORED.
bool part_set(const part_bus_t *bus, part_register_t which, uint8_t value, part_problem_t *problem);

/// Always false, for the caller to return.
bool part_fail(part_problem_t *problem, part_verdict_t verdict);

#endif
