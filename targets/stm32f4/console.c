#include "console.h"

#include "board.h"
#include "nvic.h"
#include "vectors.h"

#define CONSOLE_PRIORITY 0x40u

hal_uart_t console;

void interrupt_console(void) {
    uart_stm32f4_interrupt(&console);
}

void console_open(const clocks_t *clocks) {
    const stm32f4_board_t *const board = &stm32f4_board;
    pin_function(board->console_tx.pin, board->console_tx.function, PIN_FLOATS);
    pin_function(board->console_rx.pin, board->console_rx.function, PIN_UP);
    uart_stm32f4_open(&console, board->console,
                      board->console_is_apb2 ? clocks->apb2_Hz : clocks->apb1_Hz,
                      board->console_baud);
    nvic_enable(board->console_interrupt, CONSOLE_PRIORITY);
}
