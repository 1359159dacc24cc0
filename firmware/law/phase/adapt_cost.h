/// What a change of the vibration costs, and how much acceleration may come with it.
///
///   cost = relative change of the reach
///          + accel_weight x relative change of what RMS acceleration exceeds accel_shape x reach
///          by
///          + 2 x relative change of what it exceeds its limit by
///
/// All are relative changes, so the unit does not matter and neither does a calibration. The limit
/// is accel_limit x RMS acceleration without current, which a trial measures. Formats: relative
/// changes in Q20, accelerations um/s2, limited, not wrapped. Bounded: three 32-bit divisions.
#ifndef ADAPT_COST_H
#define ADAPT_COST_H

#include "adapt_effect.h"

#define ADAPT_NO_LIMIT UINT32_MAX

enum { ADAPT_MOST_COST_Q20 = 1 << 25 }; ///< 32 times as much as before

/// What is wanted. A shape of 0: all acceleration counts. The shape that the pulse has on the plant
/// that it was made for: acceleration counts where it becomes worse, relatively, than there.
typedef struct {
    uint16_t accel_weight_q8;
    uint16_t accel_shape_q14;
    uint16_t accel_limit_pct; ///< of RMS acceleration over that without current; 0: none
} adapt_goal_t;

/// Most RMS acceleration; ADAPT_NO_LIMIT without a limit, or where free_rms_um_s2, the one without
/// current, is 0: not known.
uint32_t adapt_limit_um_s2(adapt_goal_t goal, uint32_t free_rms_um_s2);

/// Of going from one effect to another, within +-ADAPT_MOST_COST_Q20 whatever weight a table
/// brings.
int32_t adapt_cost_q20(adapt_effect_t from, adapt_effect_t to, adapt_goal_t goal,
                       uint32_t limit_um_s2);

/// Relative change of the reach.
int32_t adapt_drift_q20(adapt_effect_t from, adapt_effect_t to);

#endif
