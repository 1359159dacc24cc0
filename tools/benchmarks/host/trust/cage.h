/// Where a controller with flipped bits runs: a process of its own that can compute and end,
/// nothing else. A pointer that is flipped leads anywhere; a call that goes astray must not start
/// processes or touch files.
#ifndef CAGE_H
#define CAGE_H

#include <stdbool.h>

/// Whether a process in it is ended by any call that it is not to make.
bool cage_is_tight(void);

/// Runs work; what it is to leave behind goes to shared memory. Returns false iff it did not come
/// to its end, or not within 0.4 s of computing.
bool cage_run(void (*work)(void *context), void *context);

/// Memory that it shares with its caller, all 0; the program ends where there is none.
void *cage_share(unsigned long bytes);

#endif
