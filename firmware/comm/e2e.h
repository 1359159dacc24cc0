/// Protection of safety-relevant CAN messages: an alive counter and a CRC-8. Whether a counter is
/// the right one at its time says freshness.h.
///
/// CRC-8 SAE J1850 (polynomial 0x1D, start 0xFF, inverted at the end) over the id's low byte, its
/// high byte and every data byte but the CRC's own, which is the last. Where the two fields are
/// comes from quiesce.dbc (generated/quiesce_can_tables.h).
#ifndef E2E_H
#define E2E_H

#include "can_frame.h"

#ifdef __cplusplus
extern "C" {
#endif

#define E2E_ALIVE_PERIOD 16u

typedef enum {
    E2E_OK = 0,
    E2E_WRONG_SHAPE = 1, ///< length or kind is not the message's
    E2E_WRONG_CRC = 2,
} e2e_verdict_t;

/// Where a message keeps its protection.
typedef struct {
    uint32_t id;
    uint8_t length;    ///< data bytes
    uint8_t alive_bit; ///< first of the four bits, little-endian numbering; they lie in one byte
    uint8_t crc_byte;  ///< always length - 1
} e2e_layout_t;

/// CRC of a frame's data under its id.
uint8_t e2e_crc(const e2e_layout_t *layout, const can_frame_t *frame);

/// Writes counter and CRC into a packed frame, then counts on. *alive is the sender's, 0 .. 15.
void e2e_protect(const e2e_layout_t *layout, uint8_t *alive, can_frame_t *frame);

/// Judges shape and CRC of a frame whose id is the layout's.
e2e_verdict_t e2e_check(const e2e_layout_t *layout, const can_frame_t *frame);

/// The counter of a frame, 0 .. 15.
uint8_t e2e_alive(const e2e_layout_t *layout, const can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
