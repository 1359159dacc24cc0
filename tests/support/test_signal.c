#include "test_signal.h"

#include "cosine_table.h"

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

int32_t signal_noise(uint32_t *seed, int32_t span) {
    *seed = *seed * 1664525u + 1013904223u;
    const int64_t step = (int64_t)(*seed >> 8) * (2 * (int64_t)span + 1) >> 24;
    return (int32_t)(step - span);
}
