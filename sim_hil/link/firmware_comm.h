/// The target's communication headers, as the C++ side sees them: shared-RAM mailbox, SLCAN codec
/// and the generated CAN messages.
#ifndef QUIESCE_FIRMWARE_COMM_H
#define QUIESCE_FIRMWARE_COMM_H

extern "C" {
#include "mailbox.h"
}

#include "quiesce_can.h"
#include "quiesce_can_tables.h"
#include "slcan.h"

#endif
