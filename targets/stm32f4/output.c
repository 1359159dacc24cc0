#include "output.h"

#include "board.h"
#include "cycles.h"
#include "dac.h"
#include "nvic.h"
#include "stm32f4_interrupts.h"
#include "vectors.h"

#define CURRENT_PRIORITY 0x10u

static struct {
    board_output_t kind;
    bridge_t bridge;
    current_loop_t loop;
    volatile uint32_t steps;          ///< of the current loop
    uint32_t steps_alive;             ///< at the last output_is_alive
    uint32_t steps_measured;          ///< at the last output_measure
    bool has_missed;                  ///< a step, between the last two of those
    volatile uint32_t longest_cycles; ///< of a step, since output_longest_cycles
    volatile bridge_measured_t measured;
} output;

static void step_loop(void) {
    const bridge_measured_t measured = bridge_take(&output.bridge);
    output.measured.current_mA = measured.current_mA;
    output.measured.supply_mV = measured.supply_mV;
    output.steps = output.steps + 1u;
    if (bridge_is_on()) {
        bridge_duty(&output.bridge,
                    current_loop_step(&output.loop, measured.current_mA, measured.supply_mV));
    } else {
        bridge_duty(&output.bridge, 0);
        current_loop_rest(&output.loop);
    }
}

void interrupt_current(void) {
    const uint32_t begin = cycles_count();
    step_loop();
    const uint32_t taken = cycles_count() - begin;
    if (taken > output.longest_cycles) {
        output.longest_cycles = taken;
    }
}

uint32_t output_longest_cycles(void) {
    nvic_hold();
    const uint32_t longest = output.longest_cycles;
    output.longest_cycles = 0;
    nvic_release();
    return longest;
}

void output_open(const clocks_t *clocks) {
    output.kind = clocks->source == CLOCK_ABSENT ? OUTPUT_NONE : stm32f4_board.output;
    if (output.kind == OUTPUT_DAC) {
        dac_open();
    }
    if (output.kind == OUTPUT_BRIDGE && current_loop_init(&output.loop, &stm32f4_board.loop)) {
        bridge_open(&output.bridge, &stm32f4_board.bridge, clocks->apb2_timer_Hz);
        nvic_enable(ADC_INTERRUPT, CURRENT_PRIORITY);
    }
}

// What a window of the current loop tells, 0.1 s or more of it: a coil that is open or short.
static bool coil_has_failed(void) {
    current_loop_report_t report = {.coil = CURRENT_LOOP_UNKNOWN};
    nvic_hold();
    (void)current_loop_report(&output.loop, output.measured.supply_mV, &report);
    nvic_release();
    return report.coil == CURRENT_LOOP_OPEN || report.coil == CURRENT_LOOP_SHORT;
}

void output_measure(quiesce_driver_t *driver) {
    if (output.kind != OUTPUT_BRIDGE) {
        return;
    }
    const bool coil_fails = coil_has_failed();
    const uint32_t steps = output.steps;
    const bool is_missing = steps == output.steps_measured;
    // A tick that follows upon a late one can come between two steps of a loop that runs.
    const bool has_stopped = is_missing && output.has_missed;
    output.steps_measured = steps;
    output.has_missed = is_missing;
    driver->is_measured = !is_missing;
    driver->has_failed = has_stopped || bridge_is_cut(&output.bridge) || coil_fails;
    driver->current_mA = output.measured.current_mA;
}

static void write_bridge(int32_t current_mA, bool is_enabled) {
    nvic_hold();
    current_loop_command(&output.loop, is_enabled ? current_mA : 0);
    bridge_enable(&output.bridge, is_enabled);
    nvic_release();
}

static void write_dac(int32_t current_mA, bool is_enabled) {
    const int32_t most_mA = stm32f4_board.dac_full_scale_mA;
    const int32_t limited_mA = current_mA < most_mA ? current_mA : most_mA;
    dac_write(is_enabled && limited_mA > 0 ? (uint32_t)limited_mA * DAC_FULL / (uint32_t)most_mA
                                           : 0u);
}

void output_write(int32_t current_mA, bool is_enabled) {
    pin_write(stm32f4_board.drive_enable, is_enabled);
    if (output.kind == OUTPUT_BRIDGE) {
        write_bridge(current_mA, is_enabled);
    } else if (output.kind == OUTPUT_DAC) {
        write_dac(current_mA, is_enabled);
    }
}

void output_cut(void) {
    pin_output(stm32f4_board.drive_enable, false);
    if (stm32f4_board.output == OUTPUT_BRIDGE) {
        bridge_cut();
    }
    if (stm32f4_board.output == OUTPUT_DAC) {
        dac_write(0);
    }
}

bool output_is_alive(void) {
    const uint32_t steps = output.steps - output.steps_alive;
    output.steps_alive = output.steps;
    return output.kind != OUTPUT_BRIDGE || steps > 0u;
}
