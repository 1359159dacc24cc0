#include "fake_break.h"

#include "fake_registers.h"
#include "stm32f4_gpio.h"
#include "stm32f4_tim1.h"

#define PIN 12u
#define ALTERNATE 2u

static bool line_is_low;

void fake_break_behave(void) {
    const uint32_t bdtr = fake_get(TIM1_BASE + TIM1_BDTR);
    const bool is_timers = (fake_get(GPIOB_BASE + GPIO_MODER) >> (2u * PIN) & 3u) == ALTERNATE;
    if ((bdtr & TIM1_BDTR_BKE) != 0u && (line_is_low || !is_timers)) {
        fake_set(TIM1_BASE + TIM1_BDTR, bdtr & ~TIM1_BDTR_MOE);
        fake_set(TIM1_BASE + TIM1_SR, fake_get(TIM1_BASE + TIM1_SR) | TIM1_SR_BIF);
    }
}

void fake_break_line(bool is_low) {
    line_is_low = is_low;
    fake_break_behave();
}

void fake_break_reset(void) {
    line_is_low = false;
}
