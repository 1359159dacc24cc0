#include "test_signal.h"

#include "cosine_table.h"
#include "trig.h"

int32_t signal_sine(int32_t amplitude, uint32_t freq_mHz, uint32_t tick, uint32_t rate_Hz) {
    const uint64_t cycle = (uint64_t)rate_Hz * 1000u;
    const uint64_t turn_q24 = (((uint64_t)tick * freq_mHz % cycle) << 24) / cycle;
    const uint32_t index = (uint32_t)(turn_q24 >> 16);
    const int64_t fraction_q16 = (int64_t)(turn_q24 & 0xFFFFu);
    const int64_t here = cosine_q25[(index - 64u) & 255u];
    const int64_t after = cosine_q25[(index - 63u) & 255u];
    const int64_t value_q25 = here + ((after - here) * fraction_q16 >> 16);
    return (int32_t)(amplitude * value_q25 >> 25);
}

int32_t signal_cosine(int32_t amplitude, uint32_t phase_turn) {
    return (int32_t)(((int64_t)amplitude * sincos_q30(phase_turn).cos + (1 << 29)) >> 30);
}

int32_t signal_noise(uint32_t *seed, int32_t span) {
    *seed = *seed * 1664525u + 1013904223u;
    const int64_t step = (int64_t)(*seed >> 8) * (2 * (int64_t)span + 1) >> 24;
    return (int32_t)(step - span);
}

// The sum of twelve uniform numbers of 0 .. 1 has a variance of one.
int32_t signal_normal(uint32_t *seed, int32_t sigma) {
    int64_t sum_q24 = -INT64_C(6) * (1 << 24);
    for (uint32_t i = 0; i < 12; i++) {
        *seed = *seed * 1664525u + 1013904223u;
        sum_q24 += *seed >> 8;
    }
    return (int32_t)((sigma * sum_q24) >> 24);
}
