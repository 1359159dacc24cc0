#include "part_bus.h"

#include <string.h>

bool part_read(const part_bus_t *bus, uint8_t command, uint8_t *out, size_t count) {
    const uint8_t sent[PART_MOST_READ + 1u] = {command};
    uint8_t answer[PART_MOST_READ + 1u] = {0};
    if (count > PART_MOST_READ || !bus->exchange(bus->context, sent, answer, count + 1u)) {
        return false;
    }
    memcpy(out, &answer[1], count);
    return true;
}

bool part_write(const part_bus_t *bus, uint8_t command, uint8_t value) {
    const uint8_t sent[2] = {command, value};
    uint8_t answer[2];
    return bus->exchange(bus->context, sent, answer, sizeof sent);
}

bool part_set(const part_bus_t *bus, part_register_t which, uint8_t value,
              part_problem_t *problem) {
    uint8_t stored;
    if (!part_write(bus, which.write, value) || !part_read(bus, which.read, &stored, 1)) {
        return part_fail(problem, PART_NO_TRANSFER);
    }
    problem->bytes[0] = which.address;
    problem->bytes[1] = value;
    problem->bytes[2] = stored;
    return stored == value || part_fail(problem, PART_NOT_STORED);
}

bool part_fail(part_problem_t *problem, part_verdict_t verdict) {
    problem->verdict = verdict;
    return false;
}
