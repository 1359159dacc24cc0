/// What the program runs, as C++ sees it: node, messages, backends.
#ifndef QUIESCED_FIRMWARE_H
#define QUIESCED_FIRMWARE_H

extern "C" {
#include "accel_backends.h"
#include "can_bus.h"
#include "current_backends.h"
#include "gpio.h"
#include "nvm_file.h"
#include "nvm_slots.h"
#include "sysfs.h"
#include "tick_linux.h"
#include "watchdog.h"
}

#include "node.h"
#include "quiesce_can.h"

#endif
