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

/// An update takes up to six periods of the prescaled clock, 48 ms over 256 (ST's HAL waits as
/// long): 60 ms of polls of ten cycles and more at 168 MHz.
#define UPDATE_POLLS 1000000u

static bool is_updating(void) {
    return (reg_read(IWDG_BASE + IWDG_SR) & (IWDG_SR_PVU | IWDG_SR_RVU)) != 0u;
}

bool watchdog_set(uint32_t timeout_ms) {
    const uint32_t counts = timeout_ms * COUNTS_A_MS;
    uint32_t prescaler = 0;
    if (timeout_ms == 0u || timeout_ms > WATCHDOG_MOST_MS || is_updating()) {
        return false;
    }
    while (counts >> (LEAST_SHIFT + prescaler) > COUNTS && prescaler < MOST_PRESCALER) {
        prescaler++;
    }
    const uint32_t reload = (counts >> (LEAST_SHIFT + prescaler)) - 1u;
    if (reg_read(IWDG_BASE + IWDG_PR) == prescaler && reg_read(IWDG_BASE + IWDG_RLR) == reload) {
        return true;
    }
    reg_write(IWDG_BASE + IWDG_KR, KEY_UNLOCK);
    reg_write(IWDG_BASE + IWDG_PR, prescaler);
    reg_write(IWDG_BASE + IWDG_RLR, reload);
    reg_write(IWDG_BASE + IWDG_KR, 0); // locks, and feeds nothing
    return false;
}

bool watchdog_start(uint32_t timeout_ms) {
    if (timeout_ms == 0u || timeout_ms > WATCHDOG_MOST_MS) {
        return false;
    }
    reg_write(IWDG_BASE + IWDG_KR, KEY_START); // its clock runs from here on
    for (uint32_t i = 0; i < UPDATE_POLLS; i++) {
        if (watchdog_set(timeout_ms)) {
            watchdog_feed();
            return true;
        }
    }
    return false;
}

void watchdog_feed(void) {
    reg_write(IWDG_BASE + IWDG_KR, KEY_FEED);
}
