/// Angles as unsigned fractions of a turn, 2^32 = 360 degrees: they wrap by themselves.
#ifndef TRIG_H
#define TRIG_H

#include "cosine_table.h"
#include "fixq.h"

typedef struct {
    int32_t cos;
    int32_t sin;
} sincos_t;

/// Cosine and sine in Q30, error at most 3.1 x 10^-9. About 70 instructions, at -Os.
sincos_t sincos_q30(uint32_t turn);

/// Cosine in Q25, linear between 256 points: error at most 7.7 x 10^-5. About 10 instructions.
static inline int32_t cos_linear_q25(uint32_t turn) {
    const uint32_t i = turn >> 24;
    const int32_t here = cosine_q25[i];
    const int32_t rise = cosine_q25[(i + 1u) % COSINE_POINTS] - here;
    // |rise| < 2^20: the product with 11 bits of the fraction fits.
    return here + ((rise * (int32_t)(turn >> 13 & 0x7FFu)) >> 11);
}

/// Angle of the vector (x, y) in turns, |x|, |y| <= 2^30; 0 for (0, 0). Error at most 10^-8 turns
/// where the longer one is above 2^17 (shorter vectors: their own resolution).
uint32_t atan2_turn(int32_t y, int32_t x);

#endif
