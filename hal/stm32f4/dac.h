/// The DAC's first channel, on PA4: a command for an external driver. Untested on silicon; what to
/// measure: docs/howto/stm32f4.md.
#ifndef DAC_H
#define DAC_H

#include <stdint.h>

#define DAC_FULL 4095u

/// On, at 0.
void dac_open(void);

/// counts: 0 .. DAC_FULL of the analogue supply, limited.
void dac_write(uint32_t counts);

#endif
