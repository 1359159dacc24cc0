#include "uart_stm32f4.h"

#include "reg.h"
#include "stm32f4_rcc.h"
#include "stm32f4_usart.h"

/// A byte takes 87 us at 115200 baud: this many polls take longer, at 168 MHz.
#define SEND_POLLS 5000u

static void give_clock(uint32_t base) {
    if (base == USART1_BASE) {
        reg_set(RCC_BASE + RCC_APB2ENR, RCC_APB2ENR_USART1EN);
        (void)reg_read(RCC_BASE + RCC_APB2ENR);
        return;
    }
    reg_set(RCC_BASE + RCC_APB1ENR,
            base == USART2_BASE ? RCC_APB1ENR_USART2EN : RCC_APB1ENR_USART3EN);
    (void)reg_read(RCC_BASE + RCC_APB1ENR);
}

void uart_stm32f4_open(hal_uart_t *uart, uint32_t base, uint32_t clock_Hz, uint32_t baud) {
    uart->base = base;
    uart->put = 0;
    uart->taken = 0;
    uart->overruns = 0;
    give_clock(base);
    reg_write(base + USART_BRR, (clock_Hz + baud / 2u) / baud); // 16 samples a bit: in 1/16
    reg_write(base + USART_CR2, 0);
    reg_write(base + USART_CR3, 0);
    reg_write(base + USART_CR1, USART_CR1_UE | USART_CR1_TE | USART_CR1_RE | USART_CR1_RXNEIE);
}

static void count_overrun(hal_uart_t *uart) {
    uart->overruns += uart->overruns < UINT32_MAX ? 1u : 0u;
}

// Reading the status, then the data, clears the flags of errors as well. With RXNE the data are the
// last byte before the overrun, without it they have been read before.
void uart_stm32f4_interrupt(hal_uart_t *uart) {
    const uint32_t status = reg_read(uart->base + USART_SR);
    const uint8_t byte = (uint8_t)reg_read(uart->base + USART_DR);
    if ((status & USART_SR_ORE) != 0u) {
        count_overrun(uart);
    }
    if ((status & USART_SR_RXNE) == 0u) {
        return;
    }
    if (uart->put - uart->taken == UART_RING_BYTES) {
        count_overrun(uart);
        return;
    }
    uart->ring[uart->put % UART_RING_BYTES] = byte;
    uart->put = uart->put + 1u;
}

bool uart_stm32f4_has_come(const hal_uart_t *uart) {
    return uart->put != uart->taken;
}

bool hal_uart_read(hal_uart_t *uart, uint8_t *byte) {
    if (!uart_stm32f4_has_come(uart)) {
        return false;
    }
    *byte = uart->ring[uart->taken % UART_RING_BYTES];
    uart->taken = uart->taken + 1u;
    return true;
}

bool uart_stm32f4_is_free(const hal_uart_t *uart) {
    return (reg_read(uart->base + USART_SR) & USART_SR_TXE) != 0u;
}

void hal_uart_write(hal_uart_t *uart, uint8_t byte) {
    if (reg_wait(uart->base + USART_SR, USART_SR_TXE, USART_SR_TXE, SEND_POLLS)) {
        reg_write(uart->base + USART_DR, byte);
    }
}
