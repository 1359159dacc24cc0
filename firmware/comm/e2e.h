/// Protection of safety-relevant CAN messages: an alive counter and a CRC-8.
///
/// CRC-8 SAE J1850 (polynomial 0x1D, start 0xFF, inverted at the end) over the id's low byte, its
/// high byte and every data byte but the CRC's own, which is the last. Where the two fields are
/// comes from quiesce.dbc (generated/quiesce_can_tables.h).
#ifndef E2E_H
#define E2E_H

#include "can_frame.h"

#define E2E_ALIVE_PERIOD 16u

typedef enum {
    E2E_OK = 0,
    E2E_WRONG_SHAPE = 1, ///< length or kind is not the message's
    E2E_WRONG_CRC = 2,
    E2E_REPEATED = 3, ///< the alive counter stood still: a sender that hangs, or a replayed frame
    E2E_JUMPED = 4,   ///< more than max_lost frames are missing
} e2e_verdict_t;

/// Where a message keeps its protection.
typedef struct {
    uint32_t id;
    uint8_t length;     ///< data bytes
    uint8_t alive_bit;  ///< first of the four bits, little-endian numbering; they lie in one byte
    uint8_t crc_byte;   ///< always length - 1
    bool alive_is_free; ///< the counter is not judged (EmergencyStop, ServiceRequest)
} e2e_layout_t;

/// Of one received message. All zero: nothing has been received.
typedef struct {
    bool has_alive;
    uint8_t alive; ///< of the last frame with a right CRC
} e2e_receiver_t;

/// CRC of a frame's data under its id.
uint8_t e2e_crc(const e2e_layout_t *layout, const can_frame_t *frame);

/// Writes counter and CRC into a packed frame, then counts on. *alive is the sender's, 0 .. 15.
void e2e_protect(const e2e_layout_t *layout, uint8_t *alive, can_frame_t *frame);

/// Judges a frame whose id is the layout's. The counter of a frame with a right CRC becomes the
/// reference for the next one even where it jumped, so that a sender that was restarted is
/// accepted from its second frame on. max_lost: frames that may be missing in a row, 0 .. 14.
e2e_verdict_t e2e_check(e2e_receiver_t *self, const e2e_layout_t *layout, uint32_t max_lost,
                        const can_frame_t *frame);

/// Forgets the counter: after the message's timeout any value is right.
void e2e_forget(e2e_receiver_t *self);

#endif
