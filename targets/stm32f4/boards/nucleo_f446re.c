// ST's NUCLEO-F446RE (UM1724): the debugger's processor gives the clock and takes the console
// (USART2) to USB.
#include "board.h"
#include "stm32f4_interrupts.h"
#include "stm32f4_usart.h"
#include "usual_wiring.h"

const stm32f4_board_t stm32f4_board = {
    .name = "nucleo_f446re",
    .crystal_Hz = 8000000u,
    .crystal_is_external = true,
    .console = USART2_BASE,
    .console_interrupt = USART2_INTERRUPT,
    .console_rx = {PIN_A(3), 7},
    .console_tx = {PIN_A(2), 7},
    .console_baud = 1000000u,
    .estop = PIN_C(0),         // CN7-38, A5
    .enable = PIN_C(1),        // CN7-36, A4
    .acknowledge = PIN_C(13),  // B1, the blue button
    .fault_lamp = PIN_B(5),    // CN10-29, D4
    .drive_enable = PIN_B(10), // CN10-25, D6
    USUAL_WIRING,
};
