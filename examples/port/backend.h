/// What hal/ asks for, on this board: handles of the types that hal/include/hal/ only names.
#ifndef BACKEND_H
#define BACKEND_H

#include "hal/accel.h"
#include "hal/current.h"
#include "hal/tick.h"

struct hal_tick {
    uint32_t period_counts;
    uint32_t last_count; ///< of the timer at the last tick; it counts down
};

/// In the place of a converter: a vibration of 10 Hz at 1000 samples a second.
struct hal_accel {
    uint32_t samples;
};

/// In the place of a driver's PWM and its enable line.
struct hal_current {
    int32_t command_mA;
    bool is_enabled;
};

/// Ends the emulator; on a board without a debugger: a fault.
_Noreturn void backend_exit(int code);

#endif
