/// Read before firmware/comm/node.c makes a node without its table service of it: what a tick does
/// for tables is left out, and a frame of theirs is nobody's.
#ifndef NODE_WITHOUT_TABLES_H
#define NODE_WITHOUT_TABLES_H

#include "node.h"
#include "quiesce_can.h"

#undef QUIESCE_CAN_TABLE_DATA_FRAME_ID
#define QUIESCE_CAN_TABLE_DATA_FRAME_ID (frame->id + 1u) // never its id
#define table_service_pass(self, passed_ms) false
#define table_service_rest(self) ((void)(self))

#endif
