/// Fixed-point arithmetic shared by all blocks. Qn: an integer that counts units of 2^-n.
/// Every function is bounded, has no state and gives the same bits on every target.
/// Right shifts of negative numbers are arithmetic on every compiler that we support
/// (asserted below): they round towards minus infinity.
#ifndef FIXQ_H
#define FIXQ_H

#include <stdbool.h>
#include <stdint.h>

// cppcheck-suppress shiftNegativeLHS
_Static_assert((-3 >> 1) == -2, "arithmetic right shift");

/// value limited to low .. high (low <= high).
static inline int32_t clamp_i32(int32_t value, int32_t low, int32_t high) {
    return value < low ? low : value > high ? high : value;
}

/// value limited to low .. high (low <= high).
static inline int64_t clamp_i64(int64_t value, int64_t low, int64_t high) {
    return value < low ? low : value > high ? high : value;
}

/// Magnitude; saturates: abs_i32(INT32_MIN) = INT32_MAX.
static inline int32_t abs_i32(int32_t value) {
    return value >= 0 ? value : value == INT32_MIN ? INT32_MAX : -value;
}

/// How far two numbers are apart.
static inline uint32_t gap_u32(uint32_t a, uint32_t b) {
    return a > b ? a - b : b - a;
}

/// Ticks in a time, floor. 0 <= time_ms <= 5 x 10^7; tick_rate_Hz: a multiple of 100, at most 4000.
static inline uint32_t ticks_in_ms(int32_t time_ms, int32_t tick_rate_Hz) {
    return (uint32_t)(time_ms * (tick_rate_Hz / 100) / 10);
}

/// Ticks in a time, floor. time_us >= 0; tick_rate_Hz <= 4000.
uint32_t ticks_in_us(int32_t time_us, uint32_t tick_rate_Hz);

/// Radians a tick of a frequency, Q32, floor. freq_mHz: 0 .. 10^6; tick_rate_Hz: 1 or more.
int32_t radians_a_tick_q32(int32_t freq_mHz, uint32_t tick_rate_Hz);

/// -1, 0 or 1.
static inline int32_t sign_i64(int64_t value) {
    return (value > 0) - (value < 0);
}

/// value + 1, staying at UINT32_MAX.
static inline uint32_t increment_sat_u32(uint32_t value) {
    return value == UINT32_MAX ? value : value + 1u;
}

/// Leading zero bits of value != 0, 0 .. 63. The builtin becomes CLZ or a bounded library routine.
static inline uint32_t leading_zeros_u64(uint64_t value) {
    return (uint32_t)__builtin_clzll(value);
}

/// floor(dividend / divisor), exact, divisor 1 .. 65535. 15 instructions; the library's division of
/// 64 bit takes 70.
static inline uint64_t div_u64_u16(uint64_t dividend, uint32_t divisor) {
    // By hand, in digits of 16 bit: a remainder and the next digit fit one word.
    const uint32_t high = (uint32_t)(dividend >> 32);
    const uint32_t low = (uint32_t)dividend;
    const uint32_t upper = high % divisor << 16 | low >> 16;
    const uint32_t lower = upper % divisor << 16 | (low & UINT16_MAX);
    return (uint64_t)(high / divisor) << 32 | (upper / divisor << 16 | lower / divisor);
}

/// value / k^2 without a 64-bit division, 1 <= k < 4096; low by at most k^2 / 2^24 of it plus 1.
static inline uint64_t over_square(uint64_t value, uint32_t k) {
    const uint32_t weight_q24 = (1u << 24) / (k * k);
    return (value >> 24) * weight_q24 + (((value & 0xFFFFFFu) * weight_q24) >> 24);
}

/// floor(sqrt(value)), exact. About 90 instructions.
uint32_t isqrt_u64(uint64_t value);

/// floor(sqrt(value)), exact. Four divisions.
uint32_t isqrt_u32(uint32_t value);

/// sqrt(value), low by at most 2^-15 of it plus 1 (floor of the leading 32 bits' root).
/// Half the cost of isqrt_u64. value < 2^62.
uint32_t sqrt_fast_u64(uint64_t value);

/// log2(value) in Q8, value >= 1; 0 for value 0. Linear between powers of two: at most 0.086 low.
/// Works on the leading 32 bits, which hold the fraction whatever the value.
static inline uint32_t log2_q8_u64(uint64_t value) {
    const uint32_t high = (uint32_t)(value >> 32);
    const uint32_t lead = high != 0 ? high : (uint32_t)value;
    if (lead == 0) {
        return 0;
    }
    const uint32_t zeros = (uint32_t)__builtin_clz(lead);
    // Eight bits after the leading one; from the low word where the high one is too short.
    const uint32_t bits = zeros > 23u && high != 0
                              ? (uint32_t)(value >> (55u - zeros) & 0x1FFu) << 23
                              : lead << zeros;
    return ((high != 0 ? 63u : 31u) - zeros) << 8 | ((bits >> 23) & 0xFFu);
}

/// 2^63 / value for value >= 2^31, to 3 units; one 32-bit division and a Newton step.
static inline uint32_t reciprocal_u32(uint32_t value) {
    const uint32_t rough = (UINT32_MAX / (value >> 16)) << 14; // half of it, to 2^-15
    const int64_t error = (INT64_C(1) << 62) - (int64_t)((uint64_t)value * rough);
    const int64_t exact = ((int64_t)rough << 1) + (((error >> 16) * (int64_t)rough) >> 45);
    return exact > (int64_t)UINT32_MAX ? UINT32_MAX : (uint32_t)exact;
}

/// A positive factor as mantissa x 2^-shift, so that one multiplication applies it at full
/// precision.
typedef struct {
    int32_t mantissa; ///< 2^30 .. 2^31 - 1
    uint32_t shift;   ///< 0 .. 62
    int64_t half;     ///< of the last place that stays: what rounds to nearest
} scale_t;

/// numerator / denominator as a scale, relative error at most 2^-30.
/// numerator 1 .. 2^31 - 1, denominator 1 .. 2^31. Quotients below 2^-32 lose precision.
scale_t scale_from_ratio(uint32_t numerator, uint32_t denominator);

/// value x scale, rounded to nearest, saturated to -limit .. limit (limit >= 0).
static inline int32_t scale_apply(const scale_t *scale, int32_t value, int32_t limit) {
    const int64_t product = ((int64_t)value * scale->mantissa + scale->half) >> scale->shift;
    return (int32_t)clamp_i64(product, -(int64_t)limit, limit);
}

#endif
