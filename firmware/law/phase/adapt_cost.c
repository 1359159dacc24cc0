#include "adapt_cost.h"

enum { LIMIT_WEIGHT = 2 }; // more than any pulse gains reach by acceleration

// change / from in Q20, limited to something between a quarter and a half, to 2^-9 of itself; one
// 32-bit division.
static int32_t relative_q20(uint32_t from, int64_t change) {
    const uint32_t up = (uint32_t)__builtin_clz(from | 1u);
    const int64_t limited_change = clamp_i64(change * (INT64_C(1) << up) >> 2, -(1 << 28), 1 << 28);
    return (int32_t)limited_change / (int32_t)(((from | 1u) << up) >> 22);
}

// What RMS acceleration exceeds its shape's share of the reach by.
static int64_t over_shape_um_s2(adapt_effect_t effect, uint32_t shape_q14) {
    const int64_t free_um_s2 = (int64_t)(((uint64_t)effect.reach_um_s2 * shape_q14) >> 14);
    return clamp_i64(effect.rms_um_s2 - free_um_s2, 0, INT32_MAX);
}

static int64_t over_limit_um_s2(adapt_effect_t effect, uint32_t limit_um_s2) {
    return clamp_i64((int64_t)effect.rms_um_s2 - limit_um_s2, 0, INT32_MAX);
}

uint32_t adapt_limit_um_s2(adapt_goal_t goal, uint32_t free_rms_um_s2) {
    if (goal.accel_limit_pct == 0 || free_rms_um_s2 == 0) {
        return ADAPT_NO_LIMIT;
    }
    const uint32_t limit_q14 = goal.accel_limit_pct * 16384u / 100u;
    const uint64_t limit_um_s2 = ((uint64_t)free_rms_um_s2 * limit_q14) >> 14;
    return limit_um_s2 < ADAPT_NO_LIMIT ? (uint32_t)limit_um_s2 : ADAPT_NO_LIMIT;
}

int32_t adapt_drift_q20(adapt_effect_t from, adapt_effect_t to) {
    return relative_q20(from.reach_um_s2, (int64_t)to.reach_um_s2 - from.reach_um_s2);
}

int32_t adapt_cost_q20(adapt_effect_t from, adapt_effect_t to, adapt_goal_t goal,
                       uint32_t limit_um_s2) {
    const int64_t shape_um_s2 =
        over_shape_um_s2(to, goal.accel_shape_q14) - over_shape_um_s2(from, goal.accel_shape_q14);
    const int64_t shape_q20 = relative_q20(from.rms_um_s2, shape_um_s2);
    const int64_t limit_q20 = relative_q20(from.rms_um_s2, over_limit_um_s2(to, limit_um_s2) -
                                                               over_limit_um_s2(from, limit_um_s2));
    const int64_t cost_q20 = adapt_drift_q20(from, to) + ((shape_q20 * goal.accel_weight_q8) >> 8) +
                             LIMIT_WEIGHT * limit_q20;
    return (int32_t)clamp_i64(cost_q20, -ADAPT_MOST_COST_Q20, ADAPT_MOST_COST_Q20);
}
