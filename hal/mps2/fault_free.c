// Images that run free, without an output stage of their own.
#include "fault.h"

_Noreturn void fault_react(void) {
    fault_restart();
}
