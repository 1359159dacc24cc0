/// Arithmetic that the table engine and straight-line rule bases share, so that they agree bit for
/// bit.
#ifndef FUZZY_MATH_H
#define FUZZY_MATH_H

#include "fixq.h"

static inline uint32_t fuzzy_min(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static inline uint32_t fuzzy_max(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static inline uint64_t fuzzy_min_u64(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

static inline uint64_t fuzzy_max_u64(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

/// A strength of a weighted average: so many bits of the product that sums of them fit 64 bits with
/// their singletons. Of a base without weights all are the same multiple of the membership.
static inline uint64_t fuzzy_strength(uint32_t membership, uint32_t weight_q19, uint32_t shift) {
    return ((uint64_t)membership * weight_q19) >> shift;
}

/// A strength of a centroid: of membership * weight FUZZY_FINE_BITS more than the membership has,
/// so that sums of areas fit 64 bits.
#define FUZZY_FINE_BITS 6u
static inline uint64_t fuzzy_fine_strength(uint32_t membership, uint32_t weight_q19,
                                           uint32_t exponent) {
    return ((uint64_t)membership * weight_q19) >> (19u - FUZZY_FINE_BITS + exponent);
}

/// (a + b * distance) >> 32, floor: a straight line of a cell, its result 0 .. 2^28.
static inline uint32_t fuzzy_ramp(int64_t a, int32_t b, uint32_t distance) {
    return (uint32_t)((a + (int64_t)b * (int32_t)distance) >> 32);
}

/// numerator / denominator, to nearest (half up), exact, by two 32-bit divisions. denominator
/// 1 .. 2^21, numerator + denominator / 2 below 2^43.
static inline uint32_t fuzzy_short_quotient(uint64_t numerator, uint32_t denominator) {
    const uint64_t rounded = numerator + denominator / 2u;
    const uint32_t upper = (uint32_t)(rounded >> 11);
    const uint32_t high = upper / denominator;
    const uint32_t rest = upper - high * denominator;
    return (high << 11) + (rest << 11 | ((uint32_t)rounded & 2047u)) / denominator;
}

/// The same for any denominator above 0 and quotient below 2^32; their sum fits 64 bits.
static inline uint32_t fuzzy_quotient(uint64_t numerator, uint64_t denominator) {
    return denominator <= UINT64_C(1) << 21 && numerator < UINT64_C(1) << 42
               ? fuzzy_short_quotient(numerator, (uint32_t)denominator)
               : (uint32_t)((numerator + denominator / 2u) / denominator);
}

static inline uint32_t fuzzy_high_half(uint32_t a, uint32_t b) {
    return (uint32_t)(((uint64_t)a * b) >> 32);
}

/// How far from its own start a layer is filled.
static inline uint32_t fuzzy_fill_height(uint32_t beta, uint32_t start, uint32_t height) {
    return beta <= start ? 0 : fuzzy_min(beta - start, height);
}

/// One layer of an output set (tools/src/quiesce/rules/integers/output_shapes.py), as shares of the
/// output's span: filled up to beta it has the area beta w, w = width - beta narrowing, and the
/// moment middle beta w +- beta^2 (skew - beta skew_narrowing).
typedef struct {
    uint32_t width_q26;
    uint32_t narrowing_q28;
    uint32_t middle_q31;
    uint32_t skew_q27;
    uint32_t skew_narrowing_q29;
} fuzzy_flanks_t;

static inline uint32_t fuzzy_width_q26(fuzzy_flanks_t f, uint32_t beta_q30) {
    return f.width_q26 - fuzzy_high_half(beta_q30, f.narrowing_q28);
}

static inline uint32_t fuzzy_skew_q25(fuzzy_flanks_t f, uint32_t beta_q30) {
    const uint32_t skew_q27 = f.skew_q27 - fuzzy_high_half(beta_q30, f.skew_narrowing_q29);
    return fuzzy_high_half(beta_q30, skew_q27);
}

/// Sums of layers where some rule always fires with 1/2 or more: areas in 32 bits do.
typedef struct {
    uint32_t area_q24;
    uint64_t moment_q55;
} fuzzy_sums_t;

static inline void fuzzy_add_area(fuzzy_sums_t *sums, fuzzy_flanks_t f, uint32_t beta_q30) {
    const uint32_t area_q24 = fuzzy_high_half(beta_q30, fuzzy_width_q26(f, beta_q30));
    sums->area_q24 += area_q24;
    sums->moment_q55 += (uint64_t)area_q24 * f.middle_q31;
}

static inline void fuzzy_add_skew(fuzzy_sums_t *sums, fuzzy_flanks_t f, uint32_t beta_q30) {
    sums->moment_q55 += (uint64_t)beta_q30 * fuzzy_skew_q25(f, beta_q30);
}

/// (more - less): moment / area in counts, to nearest, within 1 + span / 2^20. 0 .. span.
static inline uint32_t fuzzy_centre(fuzzy_sums_t more, fuzzy_sums_t less, uint32_t span) {
    const uint32_t area_q22 = (more.area_q24 - less.area_q24) >> 2;
    const uint32_t moment_q22 = (uint32_t)((more.moment_q55 - less.moment_q55) >> 33);
    const uint32_t divisor = area_q22 == 0 ? 1u : area_q22;
    const uint32_t high = (moment_q22 << 10) / divisor;
    const uint32_t rest = (moment_q22 << 10) - high * divisor;
    const uint32_t ratio_q20 = (high << 10) + (rest << 10) / divisor;
    return fuzzy_min((uint32_t)(((uint64_t)ratio_q20 * span + (1u << 19)) >> 20), span);
}

/// Sums of layers where rules may fire as weakly as they like.
typedef struct {
    uint64_t area;   ///< 2^-(bits + 26)
    uint64_t moment; ///< 2^-(bits + 28)
} fuzzy_wide_sums_t;

static inline uint32_t fuzzy_q30(uint64_t beta, uint32_t bits) {
    return (uint32_t)(bits < 30u ? beta << (30u - bits) : beta >> (bits - 30u));
}

/// beta: 2^-bits; the sums' units below follow. steep: narrowing, skew and skew_narrowing are
/// 2^-steep of their values.
static inline void fuzzy_add_wide_area(fuzzy_wide_sums_t *sums, fuzzy_flanks_t f, uint32_t steep,
                                       uint32_t bits, uint64_t beta) {
    const uint32_t narrowed = fuzzy_high_half(fuzzy_q30(beta, bits), f.narrowing_q28) << steep;
    const uint32_t width_q26 = f.width_q26 - fuzzy_min(narrowed, f.width_q26);
    sums->area += beta * width_q26;
    sums->moment += beta * (fuzzy_high_half(width_q26 << 5, f.middle_q31) >> 2);
}

static inline void fuzzy_add_wide_skew(fuzzy_wide_sums_t *sums, fuzzy_flanks_t f, uint32_t steep,
                                       uint32_t bits, uint64_t beta) {
    sums->moment += beta * (fuzzy_skew_q25(f, fuzzy_q30(beta, bits)) << steep) * 8u;
}

/// (more - less): moment / area in counts, to nearest, from 21 significant bits. 0 .. span.
static inline uint32_t fuzzy_wide_centre(fuzzy_wide_sums_t more, fuzzy_wide_sums_t less,
                                         uint32_t span) {
    // Each sum may wrap; their differences do not.
    const uint64_t area = (int64_t)(more.area - less.area) > 0 ? more.area - less.area : 1u;
    const uint64_t moment =
        (int64_t)(more.moment - less.moment) > 0 ? more.moment - less.moment : 0;
    const uint32_t zeros = leading_zeros_u64(area);
    const uint64_t divisor = zeros < 43u ? area >> (43u - zeros) : area << (zeros - 43u);
    const uint64_t scaled = zeros < 43u ? moment >> (43u - zeros) : moment << (zeros - 43u);
    return fuzzy_min(fuzzy_quotient(scaled * span, divisor << 2), span);
}

#endif
