#include "fuzzy_norms.h"

#define ONE_q60 (UINT64_C(1) << 60)

// numerator / denominator, at most 1; 0 of nothing. Both below 2^62 in the same format: shifted so
// far that all bits of the smaller one count.
static uint32_t ratio_q30(uint64_t numerator, uint64_t denominator) {
    if (denominator == 0 || numerator >= denominator) {
        return denominator == 0 ? 0 : FUZZY_ONE_q30;
    }
    const uint32_t zeros = leading_zeros_u64(denominator);
    const uint32_t up = zeros < 30u ? zeros : 30u;
    return (uint32_t)((numerator << up) / (denominator >> (30u - up)));
}

static uint32_t t_norm(fuzzy_norm_t norm, uint32_t a, uint32_t b) {
    const uint32_t least = fuzzy_min(a, b);
    const uint32_t most = fuzzy_max(a, b);
    const uint64_t product_q60 = (uint64_t)a * b;
    const uint64_t sum_q60 = ((uint64_t)a + b) << 30;
    switch (norm) {
    case FUZZY_PRODUCT:
        return fuzzy_product_q30(a, b);
    case FUZZY_BOUNDED_DIFFERENCE:
        return a + b > FUZZY_ONE_q30 ? a + b - FUZZY_ONE_q30 : 0;
    case FUZZY_DRASTIC_PRODUCT:
        return most == FUZZY_ONE_q30 ? least : 0;
    case FUZZY_EINSTEIN_PRODUCT:
        return ratio_q30(product_q60, 2u * ONE_q60 - (sum_q60 - product_q60));
    case FUZZY_HAMACHER_PRODUCT:
        return ratio_q30(product_q60, sum_q60 - product_q60);
    case FUZZY_NILPOTENT_MINIMUM:
        return a + b > FUZZY_ONE_q30 ? least : 0;
    default:
        return least;
    }
}

static uint32_t s_norm(fuzzy_norm_t norm, uint32_t a, uint32_t b) {
    const uint32_t least = fuzzy_min(a, b);
    const uint32_t most = fuzzy_max(a, b);
    const uint64_t product_q60 = (uint64_t)a * b;
    const uint64_t sum_q60 = ((uint64_t)a + b) << 30;
    switch (norm) {
    case FUZZY_ALGEBRAIC_SUM:
        return a + b - fuzzy_product_q30(a, b);
    case FUZZY_BOUNDED_SUM:
        return fuzzy_min(a + b, FUZZY_ONE_q30);
    case FUZZY_DRASTIC_SUM:
        return least == 0 ? most : FUZZY_ONE_q30;
    case FUZZY_EINSTEIN_SUM:
        return ratio_q30(sum_q60, ONE_q60 + product_q60);
    case FUZZY_HAMACHER_SUM: // where both are 1: 0 / 0, and its limit
        return most == FUZZY_ONE_q30 ? FUZZY_ONE_q30
                                     : ratio_q30(sum_q60 - 2u * product_q60, ONE_q60 - product_q60);
    case FUZZY_NILPOTENT_MAXIMUM:
        return a + b < FUZZY_ONE_q30 ? most : FUZZY_ONE_q30;
    case FUZZY_NORMALIZED_SUM: // (a + b) / max(1, a + b)
        return fuzzy_min(a + b, FUZZY_ONE_q30);
    case FUZZY_UNBOUNDED_SUM:
        return a > UINT32_MAX - b ? UINT32_MAX : a + b;
    default:
        return most;
    }
}

uint32_t fuzzy_norm(fuzzy_norm_t norm, uint32_t a_q30, uint32_t b_q30) {
    return norm < FUZZY_T_NORMS ? t_norm(norm, a_q30, b_q30) : s_norm(norm, a_q30, b_q30);
}

static uint32_t root_q30(uint32_t x_q30) {
    return isqrt_u64((uint64_t)x_q30 << 30);
}

uint32_t fuzzy_hedge(fuzzy_hedge_t hedge, uint32_t x_q30) {
    const uint32_t rest = FUZZY_ONE_q30 - x_q30;
    const bool is_low = x_q30 <= FUZZY_ONE_q30 / 2u;
    switch (hedge) {
    case FUZZY_NOT:
        return rest;
    case FUZZY_VERY:
        return fuzzy_product_q30(x_q30, x_q30);
    case FUZZY_SOMEWHAT:
        return root_q30(x_q30);
    case FUZZY_EXTREMELY:
        return is_low ? 2u * fuzzy_product_q30(x_q30, x_q30)
                      : FUZZY_ONE_q30 - 2u * fuzzy_product_q30(rest, rest);
    case FUZZY_SELDOM:
        return is_low ? root_q30(x_q30 / 2u) : FUZZY_ONE_q30 - root_q30(rest / 2u);
    case FUZZY_CUBED:
        return fuzzy_product_q30(x_q30, fuzzy_product_q30(x_q30, x_q30));
    default:
        return x_q30;
    }
}
