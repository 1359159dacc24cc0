#include "watchdog.h"

#include "reg.h"
#include "stm32f4_iwdg.h"

#define KEY_UNLOCK 0x5555u
#define KEY_FEED 0xAAAAu
#define KEY_START 0xCCCCu
#define COUNTS_A_MS 32u // of 32 kHz
#define LEAST_SHIFT 2u  // prescaler 0 divides by 4
#define MOST_PRESCALER 6u
#define COUNTS 4096u

/// Six periods of its clock, 350 us at the slowest; polls of ten cycles and more at 168 MHz.
#define UPDATE_POLLS 20000u

bool watchdog_start(uint32_t timeout_ms) {
    const uint32_t counts = timeout_ms * COUNTS_A_MS;
    uint32_t prescaler = 0;
    if (timeout_ms == 0u || timeout_ms > WATCHDOG_MOST_MS) {
        return false;
    }
    while (counts >> (LEAST_SHIFT + prescaler) > COUNTS && prescaler < MOST_PRESCALER) {
        prescaler++;
    }
    reg_write(IWDG_BASE + IWDG_KR, KEY_START); // its clock runs from here on
    if (!reg_wait(IWDG_BASE + IWDG_SR, IWDG_SR_PVU | IWDG_SR_RVU, 0, UPDATE_POLLS)) {
        return false;
    }
    const uint32_t reload = (counts >> (LEAST_SHIFT + prescaler)) - 1u;
    reg_write(IWDG_BASE + IWDG_KR, KEY_UNLOCK);
    reg_write(IWDG_BASE + IWDG_PR, prescaler);
    reg_write(IWDG_BASE + IWDG_RLR, reload);
    const bool is_taken =
        reg_wait(IWDG_BASE + IWDG_SR, IWDG_SR_PVU | IWDG_SR_RVU, 0, UPDATE_POLLS) &&
        reg_read(IWDG_BASE + IWDG_PR) == prescaler && reg_read(IWDG_BASE + IWDG_RLR) == reload;
    watchdog_feed(); // takes the new time, and locks
    return is_taken;
}

void watchdog_feed(void) {
    reg_write(IWDG_BASE + IWDG_KR, KEY_FEED);
}
