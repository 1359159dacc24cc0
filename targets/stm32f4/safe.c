#include "safe.h"

#include "board.h"
#include "fault.h"
#include "output.h"

void safe_outputs(void) {
    output_cut();
    pin_output(stm32f4_board.fault_lamp, true);
}

_Noreturn void fault_react(void) {
    safe_outputs();
    fault_restart();
}
