// Olimex STM32-H405: a crystal of 8 MHz, all pins on its two connectors. QEMU's netduinoplus2 runs
// its image as it is: the same processor, the console on its first USART.
#include "board.h"
#include "stm32f4_interrupts.h"
#include "stm32f4_usart.h"
#include "usual_wiring.h"

const stm32f4_board_t stm32f4_board = {
    .name = "olimex_h405",
    .crystal_Hz = 8000000u,
    .console = USART1_BASE,
    .console_interrupt = USART1_INTERRUPT,
    .console_is_apb2 = true,
    .console_rx = {PIN_A(10), 7},
    .console_tx = {PIN_A(9), 7},
    .console_baud = 1000000u,
    .estop = PIN_C(0),
    .enable = PIN_C(1),
    .acknowledge = PIN_C(2),
    .fault_lamp = PIN_B(5),
    .drive_enable = PIN_B(10),
    USUAL_WIRING,
};
