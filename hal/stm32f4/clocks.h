/// The clock tree: 168 MHz from a crystal, else from the internal oscillator, else its 16 MHz as
/// they are. Untested on silicon; what to measure: docs/howto/stm32f4.md.
#ifndef CLOCKS_H
#define CLOCKS_H

#include <stdbool.h>
#include <stdint.h>

typedef enum {
    CLOCK_CRYSTAL = 0,      ///< through the PLL; the clock security system watches it
    CLOCK_INTERNAL_PLL = 1, ///< the crystal did not start: internal oscillator through the PLL, 1 %
    CLOCK_INTERNAL = 2,     ///< the PLL did not lock: 16 MHz
    CLOCK_ABSENT = 3,       ///< no such registers: an emulator, which has its own rates
} clock_source_t;

typedef struct {
    clock_source_t source;
    uint32_t core_Hz;
    uint32_t apb1_Hz;       ///< USART2, USART3, SPI2, bxCAN, DAC
    uint32_t apb2_Hz;       ///< USART1, SPI1, ADC
    uint32_t apb1_timer_Hz; ///< TIM5
    uint32_t apb2_timer_Hz; ///< TIM1
} clocks_t;

/// From a reset, once; 0.1 s at the most. crystal_Hz: whole MHz of 4 .. 26, 0: there is none.
/// is_external: a clock signal comes in its place (NUCLEO: from the debugger's processor).
void clocks_start(clocks_t *clocks, uint32_t crystal_Hz, bool is_external);

#endif
