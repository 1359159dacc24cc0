#include "backend.h"

#define CORE_Hz 168000000u
#define SYSTICK_CONTROL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xE000E014u)
#define SYSTICK_COUNT (*(volatile uint32_t *)0xE000E018u)
#define SYSTICK_ENABLE 5u // of the core's clock, without an interrupt
#define SYSTICK_MOST 0x00FFFFFFu

// The count wraps after 99 ms: to be asked more often than that.
bool hal_tick_start(hal_tick_t *tick, uint32_t rate_Hz) {
    if (rate_Hz == 0 || rate_Hz > 100000 || CORE_Hz % rate_Hz != 0 ||
        CORE_Hz / rate_Hz > SYSTICK_MOST / 2u) {
        return false;
    }
    tick->period_counts = CORE_Hz / rate_Hz;
    SYSTICK_RELOAD = SYSTICK_MOST;
    SYSTICK_COUNT = 0;
    SYSTICK_CONTROL = SYSTICK_ENABLE;
    tick->last_count = SYSTICK_COUNT;
    return true;
}

uint32_t hal_tick_elapsed(hal_tick_t *tick) {
    const uint32_t passed = (tick->last_count - SYSTICK_COUNT) & SYSTICK_MOST;
    const uint32_t ticks = passed / tick->period_counts;
    tick->last_count = (tick->last_count - ticks * tick->period_counts) & SYSTICK_MOST;
    return ticks;
}

// A parabola for each half period of 50 samples; counts of 58 um/s2, up to 10 m/s2.
bool hal_accel_read(hal_accel_t *accel, hal_axis_t axis, int32_t *counts) {
    (void)axis; // it has one
    const uint32_t at = accel->samples++ % 100u;
    const int32_t within = (int32_t)(at % 50u);
    const int32_t bow = 4 * within * (50 - within) * 1000 / 58;
    *counts = at < 50u ? bow : -bow;
    return true;
}

void hal_current_write(hal_current_t *driver, int32_t current_mA, bool enable) {
    driver->command_mA = current_mA;
    driver->is_enabled = enable;
}

bool hal_current_read(hal_current_t *driver, int32_t *current_mA) {
    (void)driver;
    (void)current_mA;
    return false; // it measures nothing
}

_Noreturn void backend_exit(int code) {
    // SYS_EXIT_EXTENDED with ADP_Stopped_ApplicationExit, of Arm's semihosting.
    const uint32_t ended[2] = {0x20026u, (uint32_t)code};
    register uint32_t operation __asm__("r0") = 0x20u;
    register const uint32_t *parameter __asm__("r1") = ended;
    __asm__ volatile("bkpt 0xAB" : : "r"(operation), "r"(parameter) : "memory");
    for (;;) {
    }
}
