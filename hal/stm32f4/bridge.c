#include "bridge.h"

#include "reg.h"
#include "stm32f4_adc.h"
#include "stm32f4_adc_common.h"
#include "stm32f4_rcc.h"
#include "stm32f4_tim1.h"

#define TIM(r) (TIM1_BASE + (r))
#define ADC(r) (ADC1_BASE + (r))

#define TIMER_FUNCTION 1u // alternate function of TIM1's pins
#define PWM_MODE_1 6u     // of OC1M: on from the period's begin
#define TRIGGER_UPDATE 2u // of MMS
#define EVERY_SECOND 1u   // repetitions before an update
#define DIVIDE_4 1u       // of ADCPRE: 21 MHz of 84
#define FROM_TIM1 1u      // of JEXTSEL: TIM1's trigger output
#define RISING 1u         // of JEXTEN
#define TWO 1u            // of JL
#define SAMPLE_28_CYCLES 2u
#define SAMPLE_BITS 3u
// Flags that a zero clears: the others are written as ones.
#define ADC_FLAGS 0x3Fu
#define TIMER_FLAGS 0x1EFFu

static void open_timer(bridge_t *self, uint32_t timer_Hz) {
    self->period_counts = timer_Hz / BRIDGE_PWM_HZ;
    reg_write(TIM(TIM1_ARR), self->period_counts - 1u);
    reg_write(TIM(TIM1_PSC), 0);
    reg_write(TIM(TIM1_RCR), EVERY_SECOND);
    reg_write(TIM(TIM1_CCR1), 0);
    reg_write(TIM(TIM1_CCMR1_OUTPUT),
              PWM_MODE_1 << TIM1_CCMR1_OUTPUT_OC1M_AT | TIM1_CCMR1_OUTPUT_OC1PE);
    reg_write(TIM(TIM1_CCER), TIM1_CCER_CC1E);
    reg_write(TIM(TIM1_CR2), TRIGGER_UPDATE << TIM1_CR2_MMS_AT); // idle: low
    // Break on a low level, no automatic restart; off means driven low.
    reg_write(TIM(TIM1_BDTR), TIM1_BDTR_BKE | TIM1_BDTR_OSSI | TIM1_BDTR_OSSR);
    reg_write(TIM(TIM1_EGR), TIM1_EGR_UG);
    reg_write(TIM(TIM1_SR), 0);
    reg_write(TIM(TIM1_CR1), TIM1_CR1_ARPE | TIM1_CR1_CEN);
}

static void sample_longer(uint32_t channel) {
    const uint32_t offset = channel < 10u ? ADC_SMPR2 : ADC_SMPR1;
    const uint32_t at = SAMPLE_BITS * (channel % 10u);
    reg_change(ADC(offset), 7u << at, SAMPLE_28_CYCLES << at);
}

// Two injected conversions: the last places of the sequence.
static void open_adc(const bridge_wiring_t *wiring) {
    reg_change(ADC_COMMON_BASE + ADC_COMMON_CCR, ADC_COMMON_CCR_ADCPRE,
               DIVIDE_4 << ADC_COMMON_CCR_ADCPRE_AT);
    reg_write(ADC(ADC_CR1), ADC_CR1_SCAN | ADC_CR1_JEOCIE);
    sample_longer(wiring->current_channel);
    sample_longer(wiring->supply_channel);
    reg_write(ADC(ADC_JSQR), TWO << ADC_JSQR_JL_AT |
                                 (uint32_t)wiring->current_channel << ADC_JSQR_JSQ3_AT |
                                 (uint32_t)wiring->supply_channel << ADC_JSQR_JSQ4_AT);
    reg_write(ADC(ADC_CR2),
              FROM_TIM1 << ADC_CR2_JEXTSEL_AT | RISING << ADC_CR2_JEXTEN_AT | ADC_CR2_ADON);
}

void bridge_open(bridge_t *self, const bridge_wiring_t *wiring, uint32_t timer_Hz) {
    *self = (bridge_t){.wiring = *wiring};
    reg_set(RCC_BASE + RCC_APB2ENR, RCC_APB2ENR_TIM1EN | RCC_APB2ENR_ADC1EN);
    (void)reg_read(RCC_BASE + RCC_APB2ENR);
    pin_analog(wiring->current);
    pin_analog(wiring->supply);
    open_adc(wiring);
    pin_function(wiring->cut_off, TIMER_FUNCTION, PIN_UP); // before the timer looks at it
    open_timer(self, timer_Hz);
    pin_function(wiring->pwm, TIMER_FUNCTION, PIN_DOWN);
}

bridge_measured_t bridge_take(const bridge_t *self) {
    const bridge_wiring_t *const wiring = &self->wiring;
    const int32_t current = (int32_t)reg_read(ADC(ADC_JDR1)) - wiring->current_zero_counts;
    const int32_t supply = (int32_t)reg_read(ADC(ADC_JDR2));
    reg_write(ADC(ADC_SR), ADC_FLAGS & ~(ADC_SR_JEOC | ADC_SR_JSTRT));
    return (bridge_measured_t){
        .current_mA = current * wiring->current_uA_a_count / 1000,
        .supply_mV = supply * wiring->supply_uV_a_count / 1000,
    };
}

void bridge_duty(const bridge_t *self, int32_t duty) {
    const int32_t most = duty > BRIDGE_FULL ? BRIDGE_FULL : duty;
    const uint32_t limited = most < 0 ? 0u : (uint32_t)most;
    reg_write(TIM(TIM1_CCR1), self->period_counts * limited / (uint32_t)BRIDGE_FULL);
}

// While the break input is low the timer takes neither: it stays off, and is cut.
static void switch_on(const bridge_t *self) {
    bridge_duty(self, 0);
    reg_write(TIM(TIM1_SR), TIMER_FLAGS & ~TIM1_SR_BIF);
    reg_set(TIM(TIM1_BDTR), TIM1_BDTR_MOE);
}

void bridge_enable(bridge_t *self, bool is_on) {
    if (!is_on) {
        bridge_cut();
    } else if (!self->is_wanted) {
        switch_on(self);
    }
    self->is_wanted = is_on;
}

bool bridge_is_cut(const bridge_t *self) {
    return self->is_wanted && !bridge_is_on();
}

bool bridge_is_on(void) {
    return (reg_read(TIM(TIM1_BDTR)) & TIM1_BDTR_MOE) != 0u;
}

void bridge_cut(void) {
    reg_clear(TIM(TIM1_BDTR), TIM1_BDTR_MOE);
    reg_write(TIM(TIM1_CCR1), 0);
}
