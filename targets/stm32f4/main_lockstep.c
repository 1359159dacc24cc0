// The controller of a board behind a bench: it takes a tick for each stimulus that comes as a SLCAN
// frame on the console (lockstep_can.h), with the bench's samples. The board's own sensor and
// output are not used: the output stage stays off.
#include "board.h"
#include "clocks.h"
#include "console.h"
#include "lockstep_serial.h"
#include "safe.h"

int main(void) {
    static lockstep_can_t server;
    clocks_t clocks;
    safe_outputs();
    clocks_start(&clocks, stm32f4_board.crystal_Hz, stm32f4_board.crystal_is_external);
    console_open(&clocks);
    for (;;) { // one bench after the other
        lockstep_serial_serve(&server, &console);
    }
}
