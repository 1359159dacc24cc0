/// Frames of the controller's bus as other nodes send them, protected.
#ifndef CAN_MAKE_H
#define CAN_MAKE_H

#include "can_frame.h"
#include "quiesce_can.h"
#include "quiesce_can_tables.h"

can_frame_t make_stop(uint16_t code, uint8_t alive);
can_frame_t make_sample(uint32_t sensor, int32_t counts, uint8_t alive);
can_frame_t make_accel(int32_t counts, bool is_saturated, bool is_bad, uint8_t alive);
can_frame_t make_current(int16_t current_mA, uint8_t alive);
can_frame_t make_driver(int16_t current_mA, uint8_t driver_status, uint8_t alive);
can_frame_t make_driver_of(uint32_t damper, int16_t current_mA, uint8_t driver_status,
                           uint8_t alive);
can_frame_t make_operator(bool enable, bool fault_reset, uint8_t alive);
can_frame_t make_request(uint8_t operation, uint8_t index, int32_t value, uint8_t alive);

/// The frame's message, or QUIESCE_CAN_MESSAGES where it is none of the bus.
uint32_t message_of(const can_frame_t *frame);

/// Whether a frame is one of a message: its id, shape, and CRC where it has one.
bool is_well_made(const can_frame_t *frame);

#endif
