/// The controller's C interfaces, as the C++ side sees them: public header, parameters and the
/// lock-step server. The only place where sim_hil includes them.
#ifndef QUIESCE_FIRMWARE_H
#define QUIESCE_FIRMWARE_H

#include "lockstep.h"
#include "quiesce.h"
#include "quiesce_rules.h"

#endif
