// The controller with its CAN interface, free-running: SLCAN frames on UART0, the tick from the
// timer, acceleration and measured current from other nodes' frames, the demand as a frame. What is
// wired to what comes from a board that is linked in (QUIESCE_BOARD), else from parameters. What
// every such image does is in free_node.h.
#include "fault.h"
#include "free_node.h"
#include "nvm_mps2.h"
#include "tick_mps2.h"
#include "uart_mps2.h"

#include <stddef.h>

#ifdef HAS_QUIESCE_BOARD
extern const quiesce_board_t quiesce_board; // `quiesce board compile` makes it
#define WIRING (&quiesce_board)
#else
#define WIRING NULL
#endif

#define UART_BAUD 1000000u
#define COUNTS_PER_US (CMSDK_CLOCK_HZ / 1000000u)

typedef struct {
    free_node_t common;
    hal_nvm_memory_t memory;
    hal_tick_t tick;
    hal_uart_t uart;
    uint32_t restarts;
} board_t;

static void send_waiting(board_t *board) {
    uint8_t byte;
    while ((board->uart.registers->state & CMSDK_UART_STATE_TX_FULL) == 0u &&
           frame_queue_take(&board->common.queue, &byte)) {
        hal_uart_write(&board->uart, byte);
    }
}

static uint32_t us_since(const board_t *board, uint32_t count) {
    return (count - board->tick.timer->value) / COUNTS_PER_US; // it counts down
}

static void use_rate(board_t *board) {
    (void)hal_tick_start(&board->tick, (uint32_t)board->common.node.params.tick_rate_Hz);
    board->restarts = board->common.node.restarts;
}

static void run_tick(board_t *board, uint32_t ticks) {
    free_node_t *const common = &board->common;
    can_frame_t frames[NODE_MAX_FRAMES];
    const uint32_t begin = board->tick.timer->value;
    common->inputs.lateness_us = us_since(board, board->tick.last_count);
    common->inputs.rx_lost = board->uart.overruns;
    free_node_begin(common, ticks);
    const uint32_t count = node_tick(&common->node, &common->inputs, frames);
    if (free_node_end(common, frames, count)) {
        fault_forget();
    }
    common->inputs.work_us = us_since(board, begin);
    if (common->node.restarts != board->restarts) {
        use_rate(board);
    }
}

int main(void) {
    static board_t board;
    const free_node_start_t start = {
        .wiring = WIRING,
        .sources = {.enable = NODE_ENABLE_CAN, .sensors_on_bus = (1u << QUIESCE_SENSORS) - 1u},
        .memory = &board.memory,
        .is_after_fault = fault_is_recorded(),
    };
    board.memory.words = (volatile uint32_t *)NVM_MPS2_BASE;
    board.tick.timer = CMSDK_TIMER0;
    uart_mps2_open(&board.uart, CMSDK_UART0, UART_BAUD);
    free_node_start(&board.common, &start);
    use_rate(&board);
    for (;;) {
        const uint32_t ticks = hal_tick_elapsed(&board.tick);
        if (ticks > 0u) {
            run_tick(&board, ticks);
        }
        free_node_receive(&board.common, &board.uart);
        send_waiting(&board);
        free_node_store(&board.common);
    }
}
