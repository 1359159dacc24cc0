/// hal/tick.h on a free-running CMSDK timer: no interrupt, no drift; ticks are whole periods of the
/// 25 MHz count since the last call. Call hal_tick_elapsed at least every 171 s (the count's wrap).
#ifndef TICK_MPS2_H
#define TICK_MPS2_H

#include "cmsdk.h"
#include "hal/tick.h"

struct hal_tick {
    cmsdk_timer_t *timer; ///< set by the caller before hal_tick_start
    uint32_t period_counts;
    uint32_t last_count; ///< timer value at the last tick; the timer counts down
};

#endif
