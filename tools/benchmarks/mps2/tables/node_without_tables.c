// firmware/comm/node.c as it is without its table service: what a tick does for tables is left out,
// and a frame of theirs is nobody's.
#include "node.h"
#include "quiesce_can.h"

#undef QUIESCE_CAN_TABLE_DATA_FRAME_ID
#define QUIESCE_CAN_TABLE_DATA_FRAME_ID (frame->id + 1u) // never its id
#define table_service_pass(self, passed_ms) false
#define table_service_rest(self) ((void)(self))

#include "node.c"
