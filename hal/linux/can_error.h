/// What the kernel's CAN error frames say of the controller's state (linux/can/error.h).
#ifndef CAN_ERROR_H
#define CAN_ERROR_H

#include "can_types.h"

/// State after an error frame. id: with CAN_ERR_FLAG; controller_byte: data[1] of it.
can_bus_state_t can_error_state(can_bus_state_t before, uint32_t id, uint8_t controller_byte);

#endif
