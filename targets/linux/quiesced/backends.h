/// Accelerometers and current drivers. The lock-step server's simulated ones have handles of the
/// same names: no file includes both.
#ifndef QUIESCED_BACKENDS_H
#define QUIESCED_BACKENDS_H

extern "C" {
#include "accel_backends.h"
#include "current_backends.h"
}

#endif
