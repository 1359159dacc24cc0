/// In the place of hal/cortex_m/cycles.h on this machine: a counter of the test's.
#ifndef CYCLES_H
#define CYCLES_H

#include <stdint.h>

uint32_t cycles_count(void);

#endif
