// Boot code, in the first sector of flash: of the two places for an image (slots.h) it starts the
// one that is wanted, and stays in the safe state where there is none. It touches nothing but the
// board's own outputs, and no record of an image.
#include "board.h"
#include "fault.h"
#include "images.h"
#include "processor.h"
#include "safe.h"
#include "vectors.h"
#include "watchdog.h"

#define TRIAL_WATCHDOG_MS 8000u

// It enables none.
void interrupt_console(void) {
    fault_react();
}

int main(void) {
    hal_nvm_memory_t memory = {.area = &nvm_stm32f4_images};
    slots_t slots;
    bool is_whole[SLOTS];
    safe_outputs();
    slots_open(&slots, &memory);
    images_look(is_whole, stm32f4_board.name);
    const uint32_t slot = slots_start(&slots, is_whole);
    if (slot < SLOTS && slots_is_trial(&slots, slot)) {
        (void)watchdog_start(TRIAL_WATCHDOG_MS); // one that hangs before its own
    }
    if (slot < SLOTS) {
        processor_run(nvm_stm32f4_images.block[slot].begin);
    }
    fault_stay_silent();
}
