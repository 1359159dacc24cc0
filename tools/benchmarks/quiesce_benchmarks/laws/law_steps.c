// Runs a law that is a table on columns of signals, for tests in Python.
#include <string.h>

#include "law.h"
#include "view_signal.h"

// The lock is the chain's; here laws are fed by hand.
struct dominant_lock {
    int none;
};
const dominant_lock_t dominant_lock = {0};

static const law_t *named(const char *name) {
    const law_t *law;
    for (int32_t i = 0; (law = law_find(i)) != NULL && strcmp(law->name, name) != 0; i++) {
    }
    return law;
}

static void put(view_t *view, uint32_t signal, int32_t value) {
    const view_quantity_t *quantity = &view_quantity[signal & 0xFFu];
    memcpy((char *)view + quantity->offset + quantity->stride * (signal >> 8), &value,
           sizeof value);
}

// What its check says; then out [ticks x QUIESCE_DAMPERS], 2^31 - 1 where it has no demand.
int32_t law_steps(const char *name, const uint32_t *words, uint32_t count, const uint32_t *signals,
                  uint32_t columns, const int32_t *values, uint32_t ticks, int32_t *out) {
    const law_t *law = named(name);
    const int32_t verdict = (int32_t)table_check(law->kind, words, count);
    static uint64_t state[LAW_STATE_BYTES / sizeof(uint64_t)];
    memset(state, 0, sizeof state);
    law_setup_t setup = {.table = words};
    view_t view = {.valid = ~UINT64_C(0)};
    for (uint32_t tick = 0; verdict == 0 && tick < ticks; tick++) {
        law_demand_t demand;
        for (uint32_t i = 0; i < columns; i++) {
            put(&view, signals[i], values[tick * columns + i]);
        }
        if (!law->step(state, &setup, &view, &demand)) {
            law_demand_all(&demand, INT32_MAX);
        }
        memcpy(&out[tick * QUIESCE_DAMPERS], &demand, sizeof demand);
    }
    return verdict;
}
