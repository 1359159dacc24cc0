#include "fixq.h"

uint32_t isqrt_u64(uint64_t value) {
    uint64_t rest = value;
    uint64_t root = 0;
    for (uint64_t bit = UINT64_C(1) << 62; bit != 0; bit >>= 2) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return (uint32_t)root;
}

uint32_t isqrt_u32(uint32_t value) {
    uint32_t rest = value;
    uint32_t root = 0;
    for (uint32_t bit = UINT32_C(1) << 30; bit != 0; bit >>= 2) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return root;
}

uint32_t sqrt_fast_u64(uint64_t value) {
    if (value <= UINT32_MAX) {
        // Shifted up by an even count, so that small values keep their precision too.
        if (value == 0) {
            return 0;
        }
        const uint32_t up = (leading_zeros_u64(value) - 32u) & ~1u;
        return isqrt_u32((uint32_t)value << up) >> (up / 2u);
    }
    const uint32_t down = (33u - leading_zeros_u64(value)) & ~1u;
    return isqrt_u32((uint32_t)(value >> down)) << (down / 2u);
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
    return (scale_t){(int32_t)mantissa, shift};
}

int32_t scale_apply(scale_t scale, int32_t value, int32_t limit) {
    const int64_t half = scale.shift == 0 ? 0 : INT64_C(1) << (scale.shift - 1u);
    const int64_t product = ((int64_t)value * scale.mantissa + half) >> scale.shift;
    return (int32_t)clamp_i64(product, -(int64_t)limit, limit);
}
