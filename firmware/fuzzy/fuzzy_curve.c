#include "fuzzy_system_forms.h"

static int32_t times_t(int32_t value, int32_t t_q31) {
    return (int32_t)(((int64_t)value * t_q31) >> 31);
}

uint32_t fuzzy_curve_at(const fuzzy_system_t *table, fuzzy_curve_t curve, int32_t least,
                        int32_t x) {
    const bool is_cubic = curve.degree == 3u;
    const int32_t *piece = fuzzy_system_at(table, curve.offset);
    uint32_t first = (uint32_t)least;
    for (uint32_t i = 1; i < curve.pieces && x > piece[0]; i++) {
        first = (uint32_t)piece[0] + 1u;
        piece += is_cubic ? FUZZY_CUBIC_WORDS : FUZZY_LINE_WORDS;
    }
    const uint32_t distance = (uint32_t)x - first;
    const int32_t t_q31 = (int32_t)(distance << ((uint32_t)piece[1] & 31u) & INT32_MAX);
    const int32_t bent_q24 = is_cubic ? times_t(piece[4] + times_t(piece[5], t_q31), t_q31) : 0;
    const int64_t slope_q24 = (int64_t)piece[3] + bent_q24;
    const int64_t value_q30 = piece[2] + ((slope_q24 * t_q31) >> 25);
    return (uint32_t)clamp_i64(value_q30, 0, FUZZY_ONE_q30);
}
