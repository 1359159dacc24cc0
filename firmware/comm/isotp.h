/// ISO-TP (ISO 15765-2) over classic frames of 8 bytes, normal addressing: one message of up to
/// 2^32 - 1 bytes at a time, in either direction. Pure: no clock, no bus, no memory for the
/// message: the caller takes the bytes as they come, and is asked for those that go.
///
/// Receives in blocks of ISOTP_BLOCK frames that are ISOTP_GAP_MS apart at least; sends as the
/// other side's flow control says, and no faster than that. Anything out of order, a frame of
/// another kind, or a second of silence gives up the message; another first frame begins anew.
#ifndef ISOTP_H
#define ISOTP_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ISOTP_BLOCK 32u         ///< frames between two flow controls of ours
#define ISOTP_GAP_MS 2u         ///< least time between two frames, STmin
#define ISOTP_PATIENCE_MS 1000u ///< N_Cr and N_Bs
#define ISOTP_FRAME_BYTES 8u

typedef enum {
    ISOTP_IDLE = 0,
    ISOTP_RECEIVING = 1,
    ISOTP_AWAITING = 2, ///< the other side's flow control
    ISOTP_SENDING = 3,
} isotp_state_t;

typedef enum { ISOTP_FLOW_CONTINUE = 0, ISOTP_FLOW_WAIT = 1, ISOTP_FLOW_OVERFLOW = 2 } isotp_flow_t;

/// Zeros: idle.
typedef struct {
    isotp_state_t state;
    uint32_t length;   ///< of the message, bytes
    uint32_t done;     ///< bytes of it that have come or gone
    uint32_t sequence; ///< of the next consecutive frame, 0 .. 15
    uint32_t in_block; ///< frames until the next flow control; sending: 0: no end
    uint32_t quiet_ms; ///< until the message is given up
    uint32_t gap_ms;   ///< sending: between two frames
    uint32_t wait_ms;  ///< sending: until the next one
    bool owes_flow;    ///< flow control is to be sent
    isotp_flow_t flow;
    bool owes_first; ///< the first frame is to be sent
} isotp_t;

/// A part of the message that came.
typedef struct {
    const uint8_t *bytes; ///< in the frame
    uint32_t count;       ///< 0: none
    uint32_t at;          ///< where in the message
} isotp_part_t;

/// Takes a frame of the other side. room: bytes that a message may have. At part.at == 0 a new
/// message begins; it is whole once isotp_is_whole.
isotp_part_t isotp_take(isotp_t *self, const uint8_t frame[ISOTP_FRAME_BYTES], uint32_t room);

/// The message that came is whole; until another one begins.
static inline bool isotp_is_whole(const isotp_t *self) {
    return self->state == ISOTP_IDLE && self->length > 0u && self->done == self->length;
}

/// Begins to send a message of more than 7 bytes. What was under way is given up.
void isotp_send(isotp_t *self, uint32_t length);

/// Byte of the message that is sent.
typedef uint8_t (*isotp_byte_t)(const void *context, uint32_t at);

/// Time passes, ms; then the next frame, where one is due. Returns false iff none is.
bool isotp_tick(isotp_t *self, uint32_t passed_ms, isotp_byte_t byte, const void *context,
                uint8_t frame[ISOTP_FRAME_BYTES]);

/// Nothing is under way: no tick needs to be told of.
static inline bool isotp_is_idle(const isotp_t *self) {
    return self->state == ISOTP_IDLE && !self->owes_flow;
}

#ifdef __cplusplus
}
#endif

#endif
