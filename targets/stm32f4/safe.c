#include "safe.h"

#include "board_stm32f4.h"
#include "fault.h"

void safe_outputs(void) {
    pin_output(stm32f4_board.drive_enable, false);
    pin_output(stm32f4_board.fault_lamp, true);
}

_Noreturn void fault_react(void) {
    safe_outputs();
    fault_restart();
}
