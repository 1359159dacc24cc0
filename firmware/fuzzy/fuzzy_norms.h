/// Norms and hedges of fuzzy logic in integers. Codes are those of a fuzzy_system_t.
///
/// Memberships and what comes of them: Q30, 0 .. 2^30. Products are rounded down, quotients too:
/// each within 2^-30, but for square roots, within 2^-15 of themselves. Bounded: 3 to 12
/// instructions; with a division (Einstein, Hamacher, normalized) about 80, with a root 90.
///
/// Source: IEC 61131-7 and the operators' textbook forms (Klir and Yuan, Fuzzy Sets and Fuzzy
/// Logic, chapter 3).
#ifndef FUZZY_NORMS_H
#define FUZZY_NORMS_H

#include "fuzzy_math.h"

#define FUZZY_ONE_q30 (UINT32_C(1) << 30)

/// Append only.
typedef enum {
    FUZZY_MINIMUM,
    FUZZY_PRODUCT,
    FUZZY_BOUNDED_DIFFERENCE, ///< max(0, a + b - 1)
    FUZZY_DRASTIC_PRODUCT,    ///< the smaller one where the other is 1, else 0
    FUZZY_EINSTEIN_PRODUCT,   ///< a b / (2 - (a + b - a b))
    FUZZY_HAMACHER_PRODUCT,   ///< a b / (a + b - a b)
    FUZZY_NILPOTENT_MINIMUM,  ///< min(a, b) where a + b > 1, else 0
    FUZZY_T_NORMS,
    FUZZY_MAXIMUM = 16,
    FUZZY_ALGEBRAIC_SUM,     ///< a + b - a b
    FUZZY_BOUNDED_SUM,       ///< min(1, a + b)
    FUZZY_DRASTIC_SUM,       ///< the larger one where the other is 0, else 1
    FUZZY_EINSTEIN_SUM,      ///< (a + b) / (1 + a b)
    FUZZY_HAMACHER_SUM,      ///< (a + b - 2 a b) / (1 - a b)
    FUZZY_NILPOTENT_MAXIMUM, ///< max(a, b) where a + b < 1, else 1
    FUZZY_NORMALIZED_SUM,    ///< (a + b) / max(1, a + b)
    FUZZY_UNBOUNDED_SUM,     ///< a + b; stays at 2^32 - 1
    FUZZY_S_NORMS_END,
} fuzzy_norm_t;

/// Append only.
typedef enum {
    FUZZY_PLAIN,
    FUZZY_NOT,       ///< 1 - x
    FUZZY_VERY,      ///< x^2
    FUZZY_SOMEWHAT,  ///< sqrt(x)
    FUZZY_EXTREMELY, ///< 2 x^2 up to 1/2, 1 - 2 (1 - x)^2 from there on
    FUZZY_SELDOM,    ///< sqrt(x / 2) up to 1/2, 1 - sqrt((1 - x) / 2) from there on
    FUZZY_CUBED,     ///< x^3
    FUZZY_HEDGES,
} fuzzy_hedge_t;

static inline uint32_t fuzzy_product_q30(uint32_t a_q30, uint32_t b_q30) {
    return (uint32_t)(((uint64_t)a_q30 * b_q30) >> 30);
}

/// Of two values up to 2^30; an unbounded sum may be larger, and takes such ones.
uint32_t fuzzy_norm(fuzzy_norm_t norm, uint32_t a_q30, uint32_t b_q30);

uint32_t fuzzy_hedge(fuzzy_hedge_t hedge, uint32_t x_q30);

#endif
