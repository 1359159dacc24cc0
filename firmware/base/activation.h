/// exp(-u) and tanh(x) of networks, Q24 in and out.
#ifndef ACTIVATION_H
#define ACTIVATION_H

#include <stdint.h>

/// exp(-u), u 0 .. 255 in Q24; rounded to nearest, within 2^-23 of the exact value, 0 from 18 on.
/// About 35 instructions.
uint32_t exp_minus_q24(uint32_t u_q24);

/// tanh(x), x within +-32 in Q24; rounded down in magnitude, within 2^-23 of the exact value; odd,
/// below 1. About 60 instructions, a 32-bit division among them.
int32_t tanh_q24(int32_t x_q24);

#endif
