#include "activation.h"

#include "fixq.h"

// 2^-f over f = 0 .. 1 as 1 + f p(f), in units of 2^-31: the least largest error of this degree,
// 6.0e-8, is 2^-24.
static const int32_t power_q31[] = {-1488516314, 515797037, -118791695, 19817792, -2048772};

#define POWERS (sizeof power_q31 / sizeof power_q31[0])
#define LOG2_E_Q31 UINT64_C(3098164009) // log2(e)

// exp(-u), u in Q24, below 2^32; 0 from 31 binary digits down. Rounded down.
static uint32_t exp_minus_q30(uint32_t u_q24) {
    const uint64_t turns_q55 = u_q24 * LOG2_E_Q31; // below 2^64: u < 2^32, log2(e) < 2 in Q31
    const uint32_t whole = (uint32_t)(turns_q55 >> 55);
    const int64_t part_q31 = (int64_t)(turns_q55 >> 24 & 0x7FFFFFFFu);
    int64_t sum_q31 = 0;
    for (uint32_t i = POWERS; i > 0; i--) {
        // Both below 2^31.
        sum_q31 = ((sum_q31 + power_q31[i - 1u]) * part_q31) >> 31;
    }
    const uint32_t value_q30 = (uint32_t)((INT64_C(1) << 30) + (sum_q31 >> 1));
    return whole > 30u ? 0 : value_q30 >> whole;
}

uint32_t exp_minus_q24(uint32_t u_q24) {
    return (exp_minus_q30(u_q24) + 32u) >> 6;
}

// (1 - e) / (1 + e) with e = exp(-2 |x|). 1 + e, in Q31 1 .. 2, is a 32-bit number once e is below
// 1; its reciprocal is 2^63 / it.
int32_t tanh_q24(int32_t x_q24) {
    const uint32_t size_q24 = (uint32_t)abs_i32(x_q24);
    const uint32_t e_q30 = size_q24 == 0 ? (1u << 30) - 1u : exp_minus_q30(2u * size_q24);
    const uint32_t reciprocal = reciprocal_u32(2u * ((1u << 30) + e_q30));
    const uint64_t product = (uint64_t)((1u << 30) - e_q30) * reciprocal;
    const int32_t tanh = (int32_t)(product >> 38);
    return x_q24 < 0 ? -tanh : tanh;
}
