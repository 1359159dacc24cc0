/// What straight-line C of a fuzzy system is made of (tools/src/quiesce/rules/straight): steps of
/// polynomials, and the lesser and greater of two strengths.
#ifndef FUZZY_POLYNOMIAL_H
#define FUZZY_POLYNOMIAL_H

#include "fuzzy_math.h"

/// base + factor * t / 2^32, floor: a step of Horner's rule for a variable that counts units of
/// 2^-32. base and factor have one unit, which is the result's; whoever chose it has seen to it
/// that nothing leaves 32 bits.
static inline int32_t fuzzy_step(int32_t base, int32_t factor, int32_t t) {
    return base + (int32_t)((uint64_t)((int64_t)factor * t) >> 32);
}

static inline int32_t fuzzy_lesser(int32_t a, int32_t b) {
    return a < b ? a : b;
}

static inline int32_t fuzzy_greater(int32_t a, int32_t b) {
    return a > b ? a : b;
}

#endif
