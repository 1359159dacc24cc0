#include "trig.h"

#define ONE_Q30 INT32_C(1073741824)
#define HALF_PI_Q30 INT64_C(1686629713)

enum { QUARTER = COSINE_POINTS / 4 };

// cos(2 pi i / 256): the second half mirrors the first, and that has the quarter twice.
static int32_t cosine_q30(uint32_t i) {
    const uint32_t at = i % COSINE_POINTS;
    const uint32_t half = at > COSINE_POINTS / 2 ? COSINE_POINTS - at : at;
    return half > QUARTER ? -cosine_quarter_q30[COSINE_POINTS / 2 - half]
                          : cosine_quarter_q30[half];
}

sincos_t sincos_q30(uint32_t turn) {
    const uint32_t nearest = (turn + (1u << 23)) >> 24;
    const int32_t c_q30 = cosine_q30(nearest);
    const int32_t s_q30 = cosine_q30(nearest - QUARTER);
    // The rest is within +-0.0123 rad: three terms of the series are exact to the last bit but one.
    const int64_t rest = (int32_t)(turn - (nearest << 24));
    const int32_t rest_q30 = (int32_t)((rest * HALF_PI_Q30) >> 30);
    const int32_t square_half_q30 = (int32_t)(((int64_t)rest_q30 * rest_q30) >> 31);
    const int32_t cube_sixth_q30 = (int32_t)(((int64_t)rest_q30 * square_half_q30) >> 30) / 3;
    const int32_t cos_q30 = ONE_Q30 - square_half_q30;
    const int32_t sin_q30 = rest_q30 - cube_sixth_q30;
    return (sincos_t){
        .cos = (int32_t)(((int64_t)c_q30 * cos_q30 - (int64_t)s_q30 * sin_q30) >> 30),
        .sin = (int32_t)(((int64_t)s_q30 * cos_q30 + (int64_t)c_q30 * sin_q30) >> 30),
    };
}

// Within 0.0007 turns for 0 <= y <= x, x > 0.
static uint32_t first_octant(int32_t y, int32_t x) {
    const uint32_t up = (uint32_t)__builtin_clz((uint32_t)x) - 1u;
    const int32_t below = ((x << up) >> 15) | 1; // at least 2^15
    const int32_t t_q15 = (y << up) / below;
    // atan(t) / 2 pi = t (1/8 + 0.0435 (1 - t)), in turns Q32.
    return (uint32_t)t_q15 * (uint32_t)(16384 + ((5702 * (32768 - t_q15)) >> 15));
}

uint32_t atan2_turn(int32_t y, int32_t x) {
    const int32_t ax = abs_i32(x);
    const int32_t ay = abs_i32(y);
    if (ax == 0 && ay == 0) {
        return 0;
    }
    uint32_t turn = ay <= ax ? first_octant(ay, ax) : (1u << 30) - first_octant(ax, ay);
    turn = x < 0 ? (1u << 31) - turn : turn;
    turn = y < 0 ? 0u - turn : turn;
    // One Newton step: what is left of the angle is its own tangent to the third order.
    const sincos_t at = sincos_q30(turn);
    const int64_t along = ((int64_t)x * at.cos + (int64_t)y * at.sin) >> 30;
    const int64_t across = (int64_t)y * at.cos - (int64_t)x * at.sin;
    // turns Q32 = ratio / 2 pi x 2^32; across carries 2^30 already.
    const int64_t rest_q30 = across / along;
    return turn + (uint32_t)((rest_q30 * INT64_C(683565276)) >> 30);
}
