// Runs the tracker of a table on columns of a damper's signals, for tests in Python.
#include <stddef.h>

#include "track.h"
#include "view_signal.h"

// By the table's first word; NULL: of none.
static const track_t *tracker_of(uint32_t magic) {
    const track_t *track = track_find(0);
    for (int32_t i = 1; track != NULL && (track->kind == NULL || track->kind->magic != magic);
         i++) {
        track = track_find(i);
    }
    return track;
}

static int32_t *place_of(view_damper_t *damper, int32_t *demand_mN, uint32_t signal) {
    return signal == VIEW_SIGNAL_DEMAND
               ? demand_mN
               : (int32_t *)(void *)((char *)damper + view_quantity[signal].offset -
                                     offsetof(view_t, damper));
}

// What its check says; then out [ticks] in mA, for damper `number`. state: TRACK_STATE_BYTES, kept.
int32_t track_steps(const uint32_t *words, uint32_t count, uint32_t number, void *state,
                    const uint32_t *signals, uint32_t columns, const int32_t *values,
                    uint32_t ticks, int32_t *out) {
    const track_t *track = tracker_of(words[0]);
    const int32_t verdict =
        (int32_t)(track == NULL ? QUIESCE_TABLE_MAGIC : table_check(track->kind, words, count));
    const track_setup_t setup = {NULL, words, number};
    for (uint32_t tick = 0; verdict == 0 && tick < ticks; tick++) {
        view_damper_t damper = {0};
        int32_t demand_mN = 0;
        for (uint32_t i = 0; i < columns; i++) {
            *place_of(&damper, &demand_mN, signals[i]) = values[tick * columns + i];
        }
        out[tick] = track->step(state, &setup, &damper, demand_mN);
    }
    return verdict;
}
