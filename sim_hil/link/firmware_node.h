/// The controller as a node of a CAN bus, as the C++ side sees it.
#ifndef QUIESCE_FIRMWARE_NODE_H
#define QUIESCE_FIRMWARE_NODE_H

#include "lockstep_node.h"

#endif
