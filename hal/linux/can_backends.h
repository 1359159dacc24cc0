/// The kinds of CAN bus.
#ifndef CAN_BACKENDS_H
#define CAN_BACKENDS_H

#include "can_types.h"
#include "linux_error.h"

/// Each returns NULL and says why. The options were checked by can_bus_open; interface is without
/// the kind's prefix.
can_bus_t *can_socket_open(const can_bus_options_t *options, linux_error_t *error);
can_bus_t *can_serial_open(const can_bus_options_t *options, linux_error_t *error);

#endif
