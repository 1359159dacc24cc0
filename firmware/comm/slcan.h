/// SLCAN: CAN frames as lines of ASCII on a byte stream, as slcand and python-can speak it.
///
/// `tIIILDD..` standard, `TIIIIIIIILDD..` extended, `r` and `R` the same without data (remote), hex
/// digits of either case, ended by CR or LF. The state is the caller's; nothing blocks or
/// allocates.
#ifndef SLCAN_H
#define SLCAN_H

#include "can_frame.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Longest line without its end: T, 8 digits of id, the length, 16 digits of data.
#define SLCAN_MAX_LINE 26u
/// Longest output of slcan_encode.
#define SLCAN_MAX_BYTES (SLCAN_MAX_LINE + 1u)

typedef struct {
    uint8_t line[SLCAN_MAX_LINE];
    uint8_t length; ///< of the line so far; SLCAN_MAX_LINE + 1: too long, dropped up to its end
    uint32_t malformed_count; ///< lines that start like a frame and are none, or are too long
    uint32_t ignored_count;   ///< other lines: an adapter's commands (open, bit rate, version ...)
} slcan_decoder_t;

void slcan_decoder_init(slcan_decoder_t *decoder);

/// Takes one received byte, whatever its value.
/// Returns true iff it completes a well-formed frame; *frame is written only then, its unused data
/// bytes 0. Lines that are none are counted and dropped. Counters wrap at 2^32.
bool slcan_decode(slcan_decoder_t *decoder, uint8_t byte, can_frame_t *frame);

/// Writes the frame as a line with its CR. Returns the number of bytes;
/// 0 iff the frame is none (id beyond its width, length > 8).
size_t slcan_encode(const can_frame_t *frame, uint8_t out[SLCAN_MAX_BYTES]);

#ifdef __cplusplus
}
#endif

#endif
