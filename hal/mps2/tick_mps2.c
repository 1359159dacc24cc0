#include "tick_mps2.h"

#define TICK_MAX_RATE_HZ 100000u

bool hal_tick_start(hal_tick_t *tick, uint32_t rate_Hz) {
    if (rate_Hz == 0 || rate_Hz > TICK_MAX_RATE_HZ || CMSDK_CLOCK_HZ % rate_Hz != 0) {
        return false;
    }
    tick->period_counts = CMSDK_CLOCK_HZ / rate_Hz;
    tick->timer->control = 0;
    tick->timer->reload = UINT32_MAX;
    tick->timer->value = UINT32_MAX;
    tick->timer->control = CMSDK_TIMER_CONTROL_ENABLE;
    tick->last_count = tick->timer->value;
    return true;
}

uint32_t hal_tick_elapsed(hal_tick_t *tick) {
    const uint32_t passed_counts = tick->last_count - tick->timer->value;
    const uint32_t ticks = passed_counts / tick->period_counts;
    tick->last_count -= ticks * tick->period_counts;
    return ticks;
}
