/// Why the processor has started.
#ifndef RESET_CAUSE_H
#define RESET_CAUSE_H

typedef enum {
    RESET_UNKNOWN = 0,
    RESET_POWER = 1,     ///< power came
    RESET_BROWN_OUT = 2, ///< the supply was too low
    RESET_PIN = 3,       ///< NRST alone
    RESET_SOFTWARE = 4,  ///< after a fault of the processor, or by a debugger
    RESET_WATCHDOG = 5,
    RESET_LOW_POWER = 6,
} reset_cause_t;

/// Reads the flags and clears them, so that the next start sees its own.
reset_cause_t reset_cause_take(void);

#endif
