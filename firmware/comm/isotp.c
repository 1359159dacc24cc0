#include "isotp.h"

// Protocol control information, the high nibble of the first byte.
enum { PCI_SINGLE = 0, PCI_FIRST = 1, PCI_CONSECUTIVE = 2, PCI_FLOW = 3 };

#define SHORT_FIRST_BYTES 6u ///< of the message in a first frame
#define LONG_FIRST_BYTES 2u  ///< likewise, after a length of 32 bits
#define SHORT_LENGTH_MOST 4095u
#define CONSECUTIVE_BYTES 7u
#define PADDING 0xCCu
#define MOST_GAP_MS 127u
#define MICROSECONDS_FROM 0xF1u ///< STmin of 100 .. 900 us
#define MICROSECONDS_TO 0xF9u

static void give_up(isotp_t *self) {
    *self = (isotp_t){0};
}

static void owe_flow(isotp_t *self, isotp_flow_t flow) {
    self->flow = flow;
    self->owes_flow = true;
    self->in_block = ISOTP_BLOCK;
}

static uint32_t length_of(const uint8_t *frame, uint32_t *header_bytes) {
    const uint32_t length = (frame[0] & 15u) << 8 | frame[1];
    *header_bytes = ISOTP_FRAME_BYTES - SHORT_FIRST_BYTES;
    if (length != 0u) {
        return length;
    }
    *header_bytes = ISOTP_FRAME_BYTES - LONG_FIRST_BYTES;
    return (uint32_t)frame[2] << 24 | (uint32_t)frame[3] << 16 | (uint32_t)frame[4] << 8 | frame[5];
}

static isotp_part_t take_first(isotp_t *self, const uint8_t *frame, uint32_t room) {
    uint32_t header_bytes;
    const uint32_t length = length_of(frame, &header_bytes);
    give_up(self);
    if (length < ISOTP_FRAME_BYTES) { // a single frame's
        return (isotp_part_t){0};
    }
    if (length > room) {
        owe_flow(self, ISOTP_FLOW_OVERFLOW);
        return (isotp_part_t){0};
    }
    self->state = ISOTP_RECEIVING;
    self->length = length;
    self->done = ISOTP_FRAME_BYTES - header_bytes;
    self->sequence = 1;
    self->quiet_ms = ISOTP_PATIENCE_MS;
    owe_flow(self, ISOTP_FLOW_CONTINUE);
    return (isotp_part_t){&frame[header_bytes], self->done, 0};
}

static isotp_part_t take_consecutive(isotp_t *self, const uint8_t *frame) {
    if (self->state != ISOTP_RECEIVING) {
        return (isotp_part_t){0};
    }
    if ((frame[0] & 15u) != self->sequence) {
        give_up(self);
        return (isotp_part_t){0};
    }
    const uint32_t left = self->length - self->done;
    const isotp_part_t part = {&frame[1], left < CONSECUTIVE_BYTES ? left : CONSECUTIVE_BYTES,
                               self->done};
    self->done += part.count;
    self->sequence = (self->sequence + 1u) & 15u;
    self->quiet_ms = ISOTP_PATIENCE_MS;
    self->in_block--;
    if (self->done == self->length) {
        self->state = ISOTP_IDLE;
    } else if (self->in_block == 0u) {
        owe_flow(self, ISOTP_FLOW_CONTINUE);
    }
    return part;
}

static uint32_t gap_ms(uint32_t st_min) {
    const bool is_below_1_ms = st_min >= MICROSECONDS_FROM && st_min <= MICROSECONDS_TO;
    const uint32_t asked_ms = is_below_1_ms ? 1u : st_min <= MOST_GAP_MS ? st_min : MOST_GAP_MS;
    return asked_ms > ISOTP_GAP_MS ? asked_ms : ISOTP_GAP_MS;
}

static void take_flow(isotp_t *self, const uint8_t *frame) {
    if (self->state != ISOTP_AWAITING) {
        return;
    }
    switch (frame[0] & 15u) {
    case ISOTP_FLOW_CONTINUE:
        self->state = ISOTP_SENDING;
        self->in_block = frame[1];
        self->gap_ms = gap_ms(frame[2]);
        self->wait_ms = 0;
        break;
    case ISOTP_FLOW_WAIT:
        self->quiet_ms = ISOTP_PATIENCE_MS;
        break;
    default:
        give_up(self);
        break;
    }
}

isotp_part_t isotp_take(isotp_t *self, const uint8_t frame[ISOTP_FRAME_BYTES], uint32_t room) {
    switch (frame[0] >> 4) {
    case PCI_FIRST:
        return take_first(self, frame, room);
    case PCI_CONSECUTIVE:
        return take_consecutive(self, frame);
    case PCI_FLOW:
        take_flow(self, frame);
        return (isotp_part_t){0};
    case PCI_SINGLE:
    default:
        give_up(self);
        return (isotp_part_t){0};
    }
}

void isotp_send(isotp_t *self, uint32_t length) {
    *self = (isotp_t){
        .state = ISOTP_AWAITING,
        .length = length,
        .quiet_ms = ISOTP_PATIENCE_MS,
        .owes_first = true,
    };
}

// ---- frames of ours -----------------------------------------------------------------------------

static void pad(uint8_t *frame, uint32_t from) {
    for (uint32_t i = from; i < ISOTP_FRAME_BYTES; i++) {
        frame[i] = PADDING;
    }
}

static void put_flow(isotp_t *self, uint8_t *frame) {
    frame[0] = (uint8_t)(PCI_FLOW << 4 | self->flow);
    frame[1] = ISOTP_BLOCK;
    frame[2] = ISOTP_GAP_MS;
    pad(frame, 3);
    self->owes_flow = false;
}

// Bytes of the message from frame[from] on.
static void put_bytes(isotp_t *self, uint8_t *frame, uint32_t from, isotp_byte_t byte,
                      const void *context) {
    uint32_t at = from;
    while (at < ISOTP_FRAME_BYTES && self->done < self->length) {
        frame[at++] = byte(context, self->done++);
    }
    pad(frame, at);
}

static void put_first(isotp_t *self, uint8_t *frame, isotp_byte_t byte, const void *context) {
    const bool is_short = self->length <= SHORT_LENGTH_MOST;
    uint32_t header_bytes = 2;
    frame[0] = (uint8_t)(PCI_FIRST << 4 | (is_short ? self->length >> 8 : 0u));
    frame[1] = (uint8_t)(is_short ? self->length & 255u : 0u);
    for (uint32_t i = 0; !is_short && i < sizeof self->length; i++) {
        frame[header_bytes++] = (uint8_t)(self->length >> (24u - 8u * i));
    }
    put_bytes(self, frame, header_bytes, byte, context);
    self->sequence = 1;
    self->quiet_ms = ISOTP_PATIENCE_MS;
    self->owes_first = false;
}

static void put_consecutive(isotp_t *self, uint8_t *frame, isotp_byte_t byte, const void *context) {
    frame[0] = (uint8_t)(PCI_CONSECUTIVE << 4 | self->sequence);
    put_bytes(self, frame, 1, byte, context);
    self->sequence = (self->sequence + 1u) & 15u;
    self->wait_ms = self->gap_ms;
    if (self->done == self->length) {
        give_up(self);
    } else if (self->in_block > 0u && --self->in_block == 0u) {
        self->state = ISOTP_AWAITING;
        self->quiet_ms = ISOTP_PATIENCE_MS;
    }
}

static uint32_t minus(uint32_t from, uint32_t amount) {
    return from > amount ? from - amount : 0u;
}

static void elapse(isotp_t *self, uint32_t passed_ms) {
    self->wait_ms = minus(self->wait_ms, passed_ms);
    if (self->state == ISOTP_RECEIVING || self->state == ISOTP_AWAITING) {
        self->quiet_ms = minus(self->quiet_ms, passed_ms);
        if (self->quiet_ms == 0u) {
            give_up(self);
        }
    }
}

bool isotp_tick(isotp_t *self, uint32_t passed_ms, isotp_byte_t byte, const void *context,
                uint8_t frame[ISOTP_FRAME_BYTES]) {
    elapse(self, passed_ms);
    if (self->owes_flow) {
        put_flow(self, frame);
        return true;
    }
    if (self->owes_first) {
        put_first(self, frame, byte, context);
        return true;
    }
    if (self->state == ISOTP_SENDING && self->wait_ms == 0u) {
        put_consecutive(self, frame, byte, context);
        return true;
    }
    return false;
}
