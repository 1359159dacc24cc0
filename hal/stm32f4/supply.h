/// The processor's supply, by its voltage detector at the highest of its levels, some 2.9 V: long
/// before it no longer works, and before flash can no longer be written (2.7 V).
#ifndef SUPPLY_H
#define SUPPLY_H

#include <stdbool.h>

/// Starts the detector and waits until the supply is high enough, a second at the most at 168 MHz.
/// From then on interrupt PVD comes when it falls, which startup.c has for a fault; enable it
/// (nvic.h) afterwards. Returns false iff the supply is too low: then nothing is watched. PWR has
/// its clock (clocks_start).
bool supply_watch(void);

#endif
