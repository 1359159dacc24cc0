#include "tick_stm32f4.h"

#include "reg.h"
#include "stm32f4_rcc.h"
#include "stm32f4_tim5.h"

#define TICK_MOST_RATE_HZ 100000u

uint32_t tick_stm32f4_count(void) {
    return reg_read(TIM5_BASE + TIM5_CNT);
}

bool hal_tick_start(hal_tick_t *tick, uint32_t rate_Hz) {
    if (rate_Hz == 0u || rate_Hz > TICK_MOST_RATE_HZ || tick->clock_Hz % rate_Hz != 0u) {
        return false;
    }
    reg_set(RCC_BASE + RCC_APB1ENR, RCC_APB1ENR_TIM5EN);
    (void)reg_read(RCC_BASE + RCC_APB1ENR);
    reg_write(TIM5_BASE + TIM5_PSC, 0);
    reg_write(TIM5_BASE + TIM5_ARR, UINT32_MAX);
    reg_write(TIM5_BASE + TIM5_EGR, TIM5_EGR_UG); // takes both over
    reg_set(TIM5_BASE + TIM5_CR1, TIM5_CR1_CEN);
    tick->period_counts = tick->clock_Hz / rate_Hz;
    tick->last_count = tick_stm32f4_count();
    return true;
}

uint32_t hal_tick_elapsed(hal_tick_t *tick) {
    const uint32_t passed = tick_stm32f4_count() - tick->last_count;
    const uint32_t ticks = passed / tick->period_counts;
    tick->last_count += ticks * tick->period_counts;
    return ticks;
}

uint32_t tick_stm32f4_left(const hal_tick_t *tick, uint32_t core_Hz) {
    const uint32_t passed = tick_stm32f4_count() - tick->last_count;
    if (passed >= tick->period_counts) {
        return 0;
    }
    return (uint32_t)((uint64_t)(tick->period_counts - passed) * core_Hz / tick->clock_Hz);
}
