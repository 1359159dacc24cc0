/// The DAC's first channel, on PA4: a command for an external driver. Unbuffered, since 0 is to be
/// 0 V: some 15 kohm, for an input of 1.5 Mohm and more. Until dac_open the pin floats: a resistor
/// to ground belongs to the driver's side of a buffer. Untested on silicon; what to measure:
/// docs/howto/stm32f4.md.
#ifndef DAC_H
#define DAC_H

#include <stdint.h>

#define DAC_FULL 4095u

/// On, at 0.
void dac_open(void);

/// counts: 0 .. DAC_FULL of the analogue supply, limited.
void dac_write(uint32_t counts);

#endif
