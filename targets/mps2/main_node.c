// The controller with its CAN interface, free-running: SLCAN frames on UART0, the tick from the
// timer, acceleration and measured current from other nodes' frames, the demand as a frame. Nobody
// waits for the host: what it does not read in time is dropped and counted. What is wired to what
// comes from a board that is linked in (QUIESCE_BOARD), else from parameters. Parameters, tables
// and what was learnt are used again after a power-up where they were saved (kept.h).
//
// After a fault of the processor (fault.h) it starts anew, in a latched fault, and stays there
// until the operator acknowledges.
#include "fault.h"
#include "kept.h"
#include "node.h"
#include "shipped.h"
#include "slcan.h"
#include "tick_mps2.h"
#include "uart_mps2.h"

#include <stddef.h>

#ifdef HAS_QUIESCE_BOARD
extern const quiesce_board_t quiesce_board; // `quiesce board compile` makes it
#define WIRING (&quiesce_board)
#else
#define WIRING NULL
#endif

// The linker's: code and constants.
extern const uint32_t program_begin[];
extern const uint32_t program_end[];

#define UART_BAUD 1000000u
#define COUNTS_PER_US (CMSDK_CLOCK_HZ / 1000000u)
/// Some 25 ms of frames: an older demand is of no use to a driver.
#define QUEUE_BYTES 512u

typedef struct {
    uint8_t bytes[QUEUE_BYTES];
    uint32_t first;
    uint32_t count;
    can_unsent_t unsent;
} queue_t;

typedef struct {
    node_t node;
    kept_t kept;
    hal_tick_t tick;
    hal_uart_t uart;
    slcan_decoder_t decoder;
    queue_t queue;
    node_inputs_t inputs;
    uint32_t restarts;
    bool is_after_fault; ///< of the processor, and nobody has acknowledged
    bool is_latched;     ///< it is the controller's fault now
} board_t;

static void put(queue_t *queue, uint8_t byte) {
    queue->bytes[(queue->first + queue->count) % QUEUE_BYTES] = byte;
    queue->count++;
}

static void enqueue(queue_t *queue, const can_frame_t *frame) {
    uint8_t text[SLCAN_MAX_BYTES];
    const size_t length = slcan_encode(frame, text);
    if (length > QUEUE_BYTES - queue->count) {
        can_unsent_count(&queue->unsent, frame->id);
        return;
    }
    for (size_t i = 0; i < length; i++) {
        put(queue, text[i]);
    }
}

static void send_waiting(board_t *board) {
    queue_t *const queue = &board->queue;
    while (queue->count > 0u && (board->uart.registers->state & CMSDK_UART_STATE_TX_FULL) == 0u) {
        hal_uart_write(&board->uart, queue->bytes[queue->first]);
        queue->first = (queue->first + 1u) % QUEUE_BYTES;
        queue->count--;
    }
}

// At most a line, so that a host that floods the line cannot hold up the tick.
static void receive_waiting(board_t *board) {
    can_frame_t frame;
    uint8_t byte;
    for (uint32_t i = 0; i < SLCAN_MAX_BYTES && hal_uart_read(&board->uart, &byte); i++) {
        if (slcan_decode(&board->decoder, byte, &frame)) {
            node_receive(&board->node, &frame);
        }
    }
}

static uint32_t us_since(const board_t *board, uint32_t count) {
    return (count - board->tick.timer->value) / COUNTS_PER_US; // it counts down
}

static void use_rate(board_t *board) {
    (void)hal_tick_start(&board->tick, (uint32_t)board->node.params.tick_rate_Hz);
    board->restarts = board->node.restarts;
}

// A fault of the processor is an emergency stop up to the first tick that has latched it.
static void keep_fault(board_t *board) {
    const bool is_fault = board->node.out.telemetry.state == QUIESCE_STATE_FAULT;
    if (board->is_after_fault && board->is_latched && !is_fault) {
        board->is_after_fault = false;
        fault_forget();
    }
    board->is_latched = board->is_after_fault && is_fault;
    board->inputs.estop = board->is_after_fault && !is_fault;
}

// After a fault: the drivers are told to be off before anything else is done. What the fault has
// cut off in the middle of a line ends here.
static void say_farewell(board_t *board) {
    can_frame_t frames[QUIESCE_DAMPERS];
    const uint32_t count = node_farewell(&board->node, frames);
    put(&board->queue, '\r');
    for (uint32_t i = 0; i < count; i++) {
        enqueue(&board->queue, &frames[i]);
    }
}

static void run_tick(board_t *board, uint32_t ticks) {
    can_frame_t frames[NODE_MAX_FRAMES];
    const uint32_t begin = board->tick.timer->value;
    board->inputs.ticks_elapsed = ticks;
    board->inputs.overruns += ticks - 1u;
    board->inputs.lateness_us = us_since(board, board->tick.last_count);
    board->inputs.unsent = board->queue.unsent;
    board->inputs.rx_lost = board->uart.overruns;
    const uint32_t count = node_tick(&board->node, &board->inputs, frames);
    for (uint32_t i = 0; i < count; i++) {
        enqueue(&board->queue, &frames[i]);
    }
    keep_fault(board);
    board->inputs.work_us = us_since(board, begin);
    if (board->node.restarts != board->restarts) {
        use_rate(board);
    }
}

// With the parameters that were saved, where they are accepted. No others raise the ceiling of the
// current that ships.
static void start_node(board_t *board) {
    static const node_sources_t sources = {.enable = NODE_ENABLE_CAN,
                                           .sensors_on_bus = (1u << QUIESCE_SENSORS) - 1u};
    node_t *const node = &board->node;
    quiesce_params_t shipped;
    quiesce_params_t params;
    quiesce_params_default(&shipped);
    kept_open(&board->kept, WIRING, &shipped);
    if (!kept_read_params(&board->kept, &params) || !node_init(node, WIRING, &params, sources)) {
        (void)node_init(node, WIRING, &shipped, sources);
    }
    if (node->board == NULL) {
        node->most_mA = shipped.max_current_mA;
    }
    node_use_store(node, kept_store, &board->kept);
}

// What was learnt comes last: it is of the law's table.
static void find_tables(board_t *board) {
    static const keeper_record_t records[] = {KEEPER_LAW_TABLE, KEEPER_TRACKER_TABLE,
                                              KEEPER_LEARNT};
    for (uint32_t i = 0; shipped_tables[i] != NULL; i++) {
        (void)node_ship(&board->node, shipped_tables[i]);
    }
    for (uint32_t i = 0; i < sizeof records / sizeof records[0]; i++) {
        const uint32_t count = kept_read(&board->kept, records[i]);
        const table_found_t found = {.record = records[i],
                                     .source = TABLE_FROM_STORE,
                                     .words = board->kept.words,
                                     .count = count,
                                     .writes = kept_writes(&board->kept, records[i])};
        keeper_found_as(&board->node.tables.keeper, records[i], board->kept.state);
        (void)node_found(&board->node, &found);
    }
}

static void store_waiting(board_t *board) {
    const hal_nvm_progress_t progress = kept_work(&board->kept);
    if (progress == HAL_NVM_DONE || progress == HAL_NVM_FAILED) {
        node_stored(&board->node, progress == HAL_NVM_DONE);
    }
}

int main(void) {
    static board_t board;

    board.tick.timer = CMSDK_TIMER0;
    uart_mps2_open(&board.uart, CMSDK_UART0, UART_BAUD);
    slcan_decoder_init(&board.decoder);
    start_node(&board);
    board.is_after_fault = fault_is_recorded();
    board.inputs.estop = board.is_after_fault;
    if (board.is_after_fault) {
        say_farewell(&board);
    }
    find_tables(&board);
    quiesce_watch(&board.node.controller, NODE_WATCHES, program_begin,
                  ((uintptr_t)program_end - (uintptr_t)program_begin) / sizeof(uint32_t));
    use_rate(&board);
    for (;;) {
        const uint32_t ticks = hal_tick_elapsed(&board.tick);
        if (ticks > 0u) {
            run_tick(&board, ticks);
        }
        receive_waiting(&board);
        send_waiting(&board);
        store_waiting(&board);
    }
}
