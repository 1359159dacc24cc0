#include "pins.h"

#include "reg.h"
#include "stm32f4_gpio.h"
#include "stm32f4_rcc.h"

#define PORT_STEP (GPIOB_BASE - GPIOA_BASE)
#define NUMBERS 16u

typedef enum { MODE_INPUT = 0, MODE_OUTPUT = 1, MODE_FUNCTION = 2, MODE_ANALOG = 3 } mode_t;

static uint32_t port_of(uint8_t pin) {
    return GPIOA_BASE + (pin / NUMBERS) * PORT_STEP;
}

static void change_two(uint8_t pin, uint32_t offset, uint32_t value) {
    const uint32_t at = 2u * (pin % NUMBERS);
    reg_change(port_of(pin) + offset, 3u << at, value << at);
}

static bool is_wired(uint8_t pin) {
    return pin != PIN_NONE;
}

static void give_clock(uint8_t pin) {
    reg_set(RCC_BASE + RCC_AHB1ENR, RCC_AHB1ENR_GPIOAEN << (pin / NUMBERS));
    (void)reg_read(RCC_BASE + RCC_AHB1ENR); // RM0090: the clock takes two cycles
}

static void use_as(uint8_t pin, mode_t mode, pin_pull_t pull) {
    change_two(pin, GPIO_PUPDR, (uint32_t)pull);
    change_two(pin, GPIO_MODER, (uint32_t)mode);
}

void pin_input(uint8_t pin, pin_pull_t pull) {
    if (is_wired(pin)) {
        give_clock(pin);
        use_as(pin, MODE_INPUT, pull);
    }
}

void pin_output(uint8_t pin, bool is_high) {
    if (is_wired(pin)) {
        give_clock(pin);
        pin_write(pin, is_high);
        use_as(pin, MODE_OUTPUT, PIN_FLOATS);
    }
}

void pin_function(uint8_t pin, uint32_t function, pin_pull_t pull) {
    const uint32_t number = pin % NUMBERS;
    const uint32_t at = 4u * (number % 8u);
    if (is_wired(pin)) {
        give_clock(pin);
        change_two(pin, GPIO_OSPEEDR, 2u); // fast: 50 MHz
        reg_change(port_of(pin) + (number < 8u ? GPIO_AFRL : GPIO_AFRH), 15u << at, function << at);
        use_as(pin, MODE_FUNCTION, pull);
    }
}

void pin_analog(uint8_t pin) {
    if (is_wired(pin)) {
        give_clock(pin);
        use_as(pin, MODE_ANALOG, PIN_FLOATS);
    }
}

bool pin_read(uint8_t pin) {
    return is_wired(pin) && (reg_read(port_of(pin) + GPIO_IDR) >> (pin % NUMBERS) & 1u) != 0u;
}

void pin_write(uint8_t pin, bool is_high) {
    if (is_wired(pin)) {
        const uint32_t bit = 1u << (pin % NUMBERS);
        reg_write(port_of(pin) + GPIO_BSRR, is_high ? bit : bit << NUMBERS);
    }
}
