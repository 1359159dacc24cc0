// The controller with its CAN interface on a board of its own, free-running: SLCAN frames on the
// console, the tick from TIM5. What every such image does is in free_node.h, what the board is in
// boards/.
#include "board.h"
#include "bus.h"
#include "clocks.h"
#include "console.h"
#include "cycles.h"
#include "fault.h"
#include "free_node.h"
#include "idle.h"
#include "image_info.h"
#include "images.h"
#include "nvic.h"
#include "nvm_stm32f4.h"
#include "output.h"
#include "processor.h"
#include "reset_cause.h"
#include "safe.h"
#include "stack.h"
#include "stm32f4_interrupts.h"
#include "stm32f4_spi.h"
#include "supply.h"
#include "tick_stm32f4.h"
#include "watchdog.h"

#include <stddef.h>

#define SUPPLY_PRIORITY 0x00u
/// Fifty lost ticks at 1 kHz; the oscillator may be half as fast again, or half as slow.
#define WATCHDOG_MS 50u
#define START_WATCHDOG_MS 2000u ///< records are read
#define ERASE_WATCHDOG_MS 8000u ///< two sectors of 2 s each, on an oscillator that is fast
#define US 1000000u

typedef struct {
    free_node_t common;
    clocks_t clocks;
    hal_nvm_memory_t memory;
    hal_tick_t tick;
    hal_accel_t accel;
    bus_t bus;
    images_t images;
    uint32_t counted_kHz; ///< the core's clock, 0: its cycles are not counted
    bool is_off;          ///< the stage, as it was written last
    bool may_erase;       ///< in the last pass
    bool acknowledge_was_up;
} board_t;

extern const image_info_t image_info; // info.c

extern const uint32_t stack_limit[]; // image.ld

static void open_inputs(void) {
    pin_input(stm32f4_board.estop, PIN_UP);
    pin_input(stm32f4_board.enable, PIN_UP);
    pin_input(stm32f4_board.acknowledge, PIN_UP);
}

static void send_waiting(board_t *board) {
    uint8_t byte;
    while (uart_stm32f4_is_free(&console) && frame_queue_take(&board->common.queue, &byte)) {
        hal_uart_write(&console, byte);
    }
}

static uint32_t us_since(const board_t *board, uint32_t count) {
    return (tick_stm32f4_count() - count) / (board->tick.clock_Hz / US);
}

// The sensor's samples come at the tick's rate; one that has no such rate gives none.
static void use_rate(board_t *board) {
    const uint32_t rate_Hz = (uint32_t)board->common.node.params.tick_rate_Hz;
    (void)accel_stm32f4_set_rate(&board->accel, rate_Hz);
    (void)hal_tick_start(&board->tick, rate_Hz);
}

// The button acknowledges where it is seen to go down: a line that is stuck does not.
static bool is_acknowledged(board_t *board) {
    const bool is_up = pin_read(stm32f4_board.acknowledge);
    const bool goes_down = board->acknowledge_was_up && !is_up;
    board->acknowledge_was_up = is_up;
    return goes_down;
}

static void read_inputs(board_t *board) {
    free_node_t *const common = &board->common;
    const hal_axis_t axis = (hal_axis_t)common->node.params.accel_axis;
    common->estop_line = pin_read(stm32f4_board.estop);
    common->inputs.enable = !pin_read(stm32f4_board.enable);
    common->inputs.fault_reset = is_acknowledged(board);
    common->inputs.rx_lost = console.overruns + board->bus.can.rx_lost;
    common->inputs.bus_off_count = board->bus.can.bus_off_count;
    common->inputs.sensor[0].is_fresh =
        hal_accel_read(&board->accel, axis, &common->inputs.sensor[0].counts);
    output_measure(&common->inputs.driver[0]);
}

static bool wants_to_erase(const board_t *board) {
    return board->memory.phase != NVM_STM32F4_IDLE ||
           board->images.memory.phase != NVM_STM32F4_IDLE;
}

// Flash waits to be erased, which the processor stands still for: the stage is off for that.
static bool is_to_be_off(const board_t *board) {
    return wants_to_erase(board) && !quiesce_is_armed(&board->common.node.controller);
}

static void write_outputs(board_t *board) {
    const quiesce_out_t *const out = &board->common.node.out;
    output_write(out->damper[0].current_cmd_mA, out->damper[0].driver_enable);
    board->is_off = !out->damper[0].driver_enable;
    pin_write(stm32f4_board.fault_lamp, out->telemetry.state == QUIESCE_STATE_FAULT);
}

// Feeds the watchdog: a tick has run, the current loop has, and the stack has not reached its end.
static void supervise(void) {
    if (output_is_alive() && *stack_limit == STACK_PAINT) {
        watchdog_feed();
    }
}

static void restart(board_t *board, const quiesce_params_t *params) {
    output_write(0, false);
    node_restart(&board->common.node, params);
    use_rate(board);
    write_outputs(board);
}

static void note_cycles(board_t *board, uint32_t begin) {
    can_cycles_t *const cycles = &board->common.inputs.cycles;
    cycles->work = cycles_count() - begin;
    cycles->interrupt = output_longest_cycles();
    cycles->core_kHz = board->counted_kHz;
}

static void run_tick(board_t *board, uint32_t ticks) {
    free_node_t *const common = &board->common;
    can_frame_t frames[NODE_MAX_FRAMES];
    const uint32_t begin = tick_stm32f4_count();
    const uint32_t begin_cycles = cycles_count();
    common->inputs.lateness_us = us_since(board, board->tick.last_count);
    read_inputs(board);
    free_node_begin(common, ticks);
    common->node.drivers_are_held = is_to_be_off(board);
    node_step(&common->node, &common->inputs);
    write_outputs(board);
    const quiesce_params_t *const params = node_task(&common->node);
    if (params != NULL) {
        restart(board, params);
    }
    const uint32_t count = node_frames(&common->node, frames);
    const bus_tick_t said = {frames, count,
                             ticks * (US / (uint32_t)common->node.params.tick_rate_Hz)};
    bus_put(&board->bus, &said, &common->queue.unsent);
    if (free_node_end(common, frames, count)) {
        fault_forget();
    }
    common->inputs.work_us = us_since(board, begin);
    note_cycles(board, begin_cycles);
    supervise();
}

// The processor stands still while flash is erased: only once the stage is off, and the
// watchdog has the time for it. The hardware takes another time within 48 ms, so that every pass
// asks for what is due. Leave is given for the pass, to who asks for it.
static void store_waiting(board_t *board) {
    const bool erases = wants_to_erase(board) && board->is_off;
    const bool has_time = watchdog_set(erases ? ERASE_WATCHDOG_MS : WATCHDOG_MS);
    const bool may_erase = erases && (has_time || board->clocks.source == CLOCK_ABSENT);
    if (may_erase && !board->may_erase) {
        watchdog_feed();
    }
    board->may_erase = may_erase;
    board->memory.may_erase = may_erase && board->memory.phase != NVM_STM32F4_IDLE;
    board->images.memory.may_erase = may_erase && board->images.memory.phase != NVM_STM32F4_IDLE;
    free_node_store(&board->common);
}

// ---- an update ----------------------------------------------------------------------------------

static uint32_t first_word(const uint8_t *bytes) {
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
           (uint32_t)bytes[3] << 24;
}

static void open_images(board_t *board) {
    static images_self_t self;
    self = (images_self_t){
        .begin = (uint32_t)(uintptr_t)image_info.begin,
        .version = image_info.version,
        .mark = first_word(image_info.seal),
        .board = stm32f4_board.name,
    };
    images_open(&board->images, &self);
    node_use_images(&board->common.node, images_store(&board->images));
    board->common.node.images.is_held = board->images.is_trial;
}

static void tick_images(board_t *board) {
    free_node_t *const common = &board->common;
    const uint32_t passed_ms = common->node.can.schedule.passed_ms;
    const images_wish_t wish = images_tick(&board->images, passed_ms, !common->is_after_fault);
    if (wish == IMAGES_RESTART && !node_has_latched_fault(&common->node)) { // which it would forget
        output_write(0, false);
        safe_outputs();
        processor_reset();
    }
    common->node.images.is_held = board->images.is_trial;
}

// In an emulator, which has neither, samples and currents are the bus's.
static bool open_sensor(board_t *board) {
    const accel_wiring_t *const wiring = &stm32f4_board.accel;
    const clocks_t *const clocks = &board->clocks;
    if (clocks->source == CLOCK_ABSENT || wiring->part == ACCEL_NONE) {
        return false;
    }
    (void)accel_stm32f4_open(&board->accel, wiring,
                             wiring->spi == SPI1_BASE ? clocks->apb2_Hz : clocks->apb1_Hz,
                             clocks->core_Hz);
    return true; // one that does not start gives no sample, and the controller says so
}

static void start_common(board_t *board) {
    board->memory.area = &nvm_stm32f4_records;
    const uint32_t every_sensor = (1u << QUIESCE_SENSORS) - 1u;
    const free_node_start_t how = {
        .wiring = NULL,
        .sources = {.enable = stm32f4_board.enable == PIN_NONE ? NODE_ENABLE_CAN : NODE_ENABLE_BOTH,
                    .sensors_on_bus = open_sensor(board) ? 0u : every_sensor},
        .memory = &board->memory,
        .is_after_fault = fault_is_recorded(),
    };
    free_node_start(&board->common, &how);
}

// Where the supply stays low it begins anew, with the outputs off: until it is back.
static void watch_supply(void) {
    if (!supply_watch()) {
        processor_reset();
    }
    nvic_enable(PVD_INTERRUPT, SUPPLY_PRIORITY);
}

static void start(board_t *board) {
    clocks_start(&board->clocks, stm32f4_board.crystal_Hz, stm32f4_board.crystal_is_external);
    if (image_state(&image_info) == IMAGE_BROKEN) {
        fault_stay_silent();
    }
    if (board->clocks.source != CLOCK_ABSENT) {
        watch_supply();
        (void)watchdog_start(
            START_WATCHDOG_MS); // it runs in any case, by half a second at the least
    }
    board->tick.clock_Hz = board->clocks.apb1_timer_Hz;
    board->counted_kHz = cycles_start() ? board->clocks.core_Hz / 1000u : 0u;
    open_inputs();
    console_open(&board->clocks);
    bus_open(&board->bus, &board->clocks);
    start_common(board);
    open_images(board);
    output_open(&board->clocks);
    use_rate(board);
}

// Sleeps where nothing waits: until the next tick, a byte or a step of the current loop. A bus that
// is not the console has three frames of room, and is asked all the time.
static void rest(const board_t *board) {
    nvic_hold();
    if (!board->bus.can.is_open && free_node_is_idle(&board->common) &&
        !uart_stm32f4_has_come(&console)) {
        idle_cycles(tick_stm32f4_left(&board->tick, board->clocks.core_Hz));
    }
    nvic_release();
}

// What the watchdog has ended counts like a fault of the processor. After too many there is nothing
// but the safe state, until power-off: asked before the watchdog runs, which would end it.
static void stop_where_nothing_helps(void) {
    if (reset_cause_take() == RESET_WATCHDOG) {
        fault_count_watchdog();
    }
    if (fault_is_final()) {
        fault_stay_silent();
    }
}

int main(void) {
    static board_t board;
    safe_outputs();
    stop_where_nothing_helps();
    start(&board);
    for (;;) {
        const uint32_t ticks = hal_tick_elapsed(&board.tick);
        if (ticks > 0u) {
            run_tick(&board, ticks);
            tick_images(&board);
        }
        free_node_receive(&board.common, &console);
        send_waiting(&board);
        bus_work(&board.bus, &board.common.node);
        store_waiting(&board);
        rest(&board);
    }
}
