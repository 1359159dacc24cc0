#include "dac.h"

#include "pins.h"
#include "reg.h"
#include "stm32f4_dac.h"
#include "stm32f4_rcc.h"

#define DAC_PIN PIN_A(4)

void dac_open(void) {
    reg_set(RCC_BASE + RCC_APB1ENR, RCC_APB1ENR_DACEN);
    (void)reg_read(RCC_BASE + RCC_APB1ENR);
    pin_analog(DAC_PIN);
    dac_write(0);
    // Its buffer reaches down to 0.2 V only: a command of some 6 % where there is to be none.
    reg_set(DAC_BASE + DAC_CR, DAC_CR_BOFF1 | DAC_CR_EN1);
}

void dac_write(uint32_t counts) {
    reg_write(DAC_BASE + DAC_DHR12R1, counts < DAC_FULL ? counts : DAC_FULL);
}
