/// What an image does about an exception that it did not expect (HardFault and its like): a record
/// in memory that start-up leaves alone, then fault_react. Nothing of the program runs any more.
///
/// fault_exit.c prints the record and ends the emulator: for tests and for images that a bench
/// drives. An image that runs free links fault_restart.c.
#ifndef FAULT_H
#define FAULT_H

#include <stdbool.h>
#include <stdint.h>

/// Exit code of an image that a fault has ended.
#define FAULT_EXIT_CODE 99

/// Restarts since the last fault_forget or power-up; after one more fault the image stays silent,
/// and the drivers' own timeouts hold the safe current.
#define FAULT_MOST_RESTARTS 3u

typedef struct {
    uint32_t magic;        ///< FAULT_MAGIC
    uint32_t count;        ///< faults since power-up or fault_forget; saturates
    uint32_t exception;    ///< 0: no processor's, the watchdog has ended the run
    uint32_t pc, lr, xpsr; ///< 0 where the stack was not in memory
    uint32_t cfsr, hfsr;   ///< configurable and hard fault status
    uint32_t check;        ///< complement of the sum of the words above
} cpu_fault_t;

#define FAULT_MAGIC 0x51464C54u

/// Survives a reset, not a power-up; then fault_is_recorded is false.
extern cpu_fault_t cpu_fault;

/// Whether a fault has ended the program's last run, and nobody has acknowledged it.
bool fault_is_recorded(void);

/// Whether it was one more than the most restarts. An image with a watchdog asks before it starts
/// that, and stays silent: the watchdog ends fault_restart's silence with a reset.
bool fault_is_final(void);

/// It is acknowledged.
void fault_forget(void);

/// Counts a fault, of which *what is the place; its magic, count and check do not matter.
void fault_count(const cpu_fault_t *what);

/// At the start, where the watchdog has reset: a fault like one of the processor, without a place.
/// What the final one has left stays.
void fault_count_watchdog(void);

/// Keeps what the core has stacked. stacked: r0 r1 r2 r3 r12 lr pc xpsr; NULL: not in memory.
void fault_keep(const uint32_t *stacked);

/// Every vector that is no interrupt of the image: keeps the record, then fault_react on a fresh
/// stack. Naked: only for a table of vectors.
void fault_handler(void);

/// After fault_keep, on a fresh stack.
_Noreturn void fault_react(void);

/// Resets the core a bounded number of times, then stays silent: the end of fault_react where no
/// debugger is.
_Noreturn void fault_restart(void);

_Noreturn void fault_stay_silent(void);

#endif
