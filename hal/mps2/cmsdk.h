/// Registers of the CMSDK peripherals that the images use (mps2-an386, 25 MHz peripheral clock).
#ifndef CMSDK_H
#define CMSDK_H

#include <stdint.h>

#define CMSDK_CLOCK_HZ 25000000u

typedef struct {
    volatile uint32_t data;
    volatile uint32_t state;
    volatile uint32_t control;
    volatile uint32_t interrupt;
    volatile uint32_t baud_divider; ///< 16 or more
} cmsdk_uart_t;

#define CMSDK_UART0 ((cmsdk_uart_t *)0x40004000u)
#define CMSDK_UART_STATE_TX_FULL 1u
#define CMSDK_UART_STATE_RX_FULL 2u
#define CMSDK_UART_STATE_RX_OVERRUN 8u ///< cleared by writing it
#define CMSDK_UART_CONTROL_TX_ENABLE 1u
#define CMSDK_UART_CONTROL_RX_ENABLE 2u

/// Counts down to 0, then restarts from reload.
typedef struct {
    volatile uint32_t control;
    volatile uint32_t value;
    volatile uint32_t reload;
    volatile uint32_t interrupt;
} cmsdk_timer_t;

#define CMSDK_TIMER0 ((cmsdk_timer_t *)0x40000000u)
#define CMSDK_TIMER1 ((cmsdk_timer_t *)0x40001000u)
#define CMSDK_TIMER_CONTROL_ENABLE 1u
#define CMSDK_TIMER_CONTROL_INTERRUPT 8u

#endif
