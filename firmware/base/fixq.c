#include "fixq.h"

uint32_t ticks_in_us(int32_t time_us, uint32_t tick_rate_Hz) {
    return (uint32_t)((int64_t)time_us * tick_rate_Hz / 1000000);
}

int32_t radians_a_tick_q32(int32_t freq_mHz, uint32_t tick_rate_Hz) {
    // 2 pi / 1000 in Q32.
    return (int32_t)(freq_mHz * INT64_C(26986075) / tick_rate_Hz);
}

uint32_t isqrt_u32(uint32_t value) {
    if (value == 0) {
        return 0;
    }
    // Newton's iteration from above, at most twice too large at first: four steps leave less
    // than 1.
    uint32_t root = 1u << ((33u - (uint32_t)__builtin_clz(value)) / 2u);
    for (uint32_t i = 0; i < 4u; i++) {
        root = (root + value / root) / 2u;
    }
    return root > UINT16_MAX || root * root > value ? root - 1u : root;
}

uint32_t isqrt_u64(uint64_t value) {
    if (value == 0) {
        return 0;
    }
    // At full scale: the upper half's root, then one Newton step for the lower 16 bits.
    const uint32_t up = leading_zeros_u64(value) & ~1u;
    const uint64_t full = value << up;
    const uint32_t high = (uint32_t)(full >> 32);
    const uint32_t half = isqrt_u32(high);
    const uint64_t rest = (uint64_t)(high - half * half) << 32 | (uint32_t)full;
    const uint64_t above = ((uint64_t)half << 16) + (uint32_t)(rest >> 17) / half;
    uint32_t root = above > UINT32_MAX ? UINT32_MAX : (uint32_t)above;
    // The step overshoots by less than 1, its rounding adds less than 1 on either side.
    for (uint32_t i = 0; i < 2u; i++) {
        root -= (uint64_t)root * root > full ? 1u : 0u;
    }
    return root >> (up / 2u);
}

uint32_t sqrt_fast_u64(uint64_t value) {
    if (value == 0) {
        return 0;
    }
    // At full scale, so that small values keep their precision too: the upper half's root.
    const uint32_t up = leading_zeros_u64(value) & ~1u;
    const uint32_t half = isqrt_u32((uint32_t)(value << up >> 32));
    return half << 16 >> (up / 2u);
}

scale_t scale_from_ratio(uint32_t numerator, uint32_t denominator) {
    uint32_t mantissa = numerator / denominator;
    uint64_t rest = numerator % denominator;
    uint32_t shift = 0;
    // Long division, one more bit a round, until the mantissa is full.
    while (mantissa < (UINT32_C(1) << 30) && shift < 62u) {
        rest <<= 1;
        mantissa <<= 1;
        if (rest >= denominator) {
            rest -= denominator;
            mantissa |= 1u;
        }
        shift++;
    }
    const int64_t half = shift == 0 ? 0 : INT64_C(1) << (shift - 1u);
    return (scale_t){(int32_t)mantissa, shift, half};
}
