/// What the program runs, as C++ sees it: node, messages, and the backends but for accelerometers
/// and current drivers, whose handles backends.h has.
#ifndef QUIESCED_FIRMWARE_H
#define QUIESCED_FIRMWARE_H

extern "C" {
#include "can_bus.h"
#include "gpio.h"
#include "node.h"
#include "nvm_file.h"
#include "quiesce_can.h"
#include "tick_linux.h"
#include "watchdog.h"
}

#endif
