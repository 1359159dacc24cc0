#include "can_error.h"

#include <linux/can.h>
#include <linux/can/error.h>

#ifndef CAN_ERR_CRTL_ACTIVE
#define CAN_ERR_CRTL_ACTIVE 0x40 // since Linux 4.6
#endif

#define PASSIVE (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)
#define WARNING (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)

can_bus_state_t can_error_state(can_bus_state_t before, uint32_t id, uint8_t controller_byte) {
    if ((id & CAN_ERR_BUSOFF) != 0u) {
        return CAN_BUS_OFF;
    }
    if ((id & CAN_ERR_RESTARTED) != 0u) {
        return CAN_BUS_UP;
    }
    if ((id & CAN_ERR_CRTL) == 0u || before == CAN_BUS_OFF || before == CAN_BUS_DOWN) {
        return before;
    }
    if ((controller_byte & PASSIVE) != 0) {
        return CAN_BUS_PASSIVE;
    }
    return (controller_byte & (WARNING | CAN_ERR_CRTL_ACTIVE)) != 0 ? CAN_BUS_UP : before;
}
