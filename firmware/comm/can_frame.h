/// One classic CAN frame.
#ifndef CAN_FRAME_H
#define CAN_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#define CAN_MAX_BYTES 8u
#define CAN_MAX_STANDARD_ID 0x7FFu
#define CAN_MAX_EXTENDED_ID 0x1FFFFFFFu

typedef struct {
    uint32_t id;      ///< 11 bits, or 29 where is_extended
    uint8_t length;   ///< data bytes, 0 .. 8; a remote frame carries the length only
    bool is_extended; ///< 29-bit id
    bool is_remote;
    uint8_t data[CAN_MAX_BYTES];
} can_frame_t;

#endif
