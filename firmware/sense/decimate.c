#include "decimate.h"

void decimate_init(decimate_t *self, uint32_t tick_rate_Hz, uint32_t sample_rate_Hz) {
    *self = (decimate_t){0};
    for (uint32_t rate = tick_rate_Hz; rate > sample_rate_Hz; rate /= 2u) {
        self->stages++;
    }
}

// Half-band low-pass: every other coefficient is zero, the rest symmetric about the middle one.
static int32_t half_band(const decimate_stage_t *stage, int32_t newest) {
    const int32_t *even = stage->even;
    const int64_t outer = (int64_t)newest + even[4];
    const int64_t inner = (int64_t)even[0] + even[3];
    const int64_t centre = (int64_t)even[1] + even[2];
    const int64_t sum_q16 =
        636 * outer - 3808 * inner + 19556 * centre + 32768 * (int64_t)stage->odd[2];
    return (int32_t)clamp_i64((sum_q16 + 32768) >> 16, -DECIMATE_LIMIT, DECIMATE_LIMIT);
}

static void push(int32_t *line, uint32_t length, int32_t value) {
    for (uint32_t i = length - 1u; i > 0; i--) {
        line[i] = line[i - 1u];
    }
    line[0] = value;
}

// One stage of decimation by two. Returns true iff *value is an output sample.
static bool halve(decimate_stage_t *stage, int32_t *value) {
    const int32_t newest = *value;
    stage->is_odd = !stage->is_odd;
    if (stage->is_odd) {
        push(stage->odd, DECIMATE_ODD, newest);
        return false;
    }
    *value = half_band(stage, newest);
    push(stage->even, DECIMATE_EVEN, newest);
    return true;
}

bool decimate_step(decimate_t *self, int32_t *value) {
    for (uint32_t i = 0; i < self->stages; i++) {
        if (!halve(&self->stage[i], value)) {
            return false;
        }
    }
    return true;
}
