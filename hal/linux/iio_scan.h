/// How an IIO buffer packs a sample of a channel (scan_elements/in_*_type), and how a scan is laid
/// out: channels in the order of their index, each at a multiple of its own size
/// (Documentation/iio/iio_devbuf.rst).
#ifndef IIO_SCAN_H
#define IIO_SCAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    bool is_big_endian;
    bool is_signed;
    uint32_t bits;    ///< 1 .. 32, of an unsigned one at most 31
    uint32_t storage; ///< bytes: 1, 2, 4 or 8
    uint32_t shift;   ///< bits
    uint32_t index;   ///< order within the scan
    uint32_t offset;  ///< bytes into the scan
} iio_channel_t;

/// Reads a type such as "le:s20/32>>4". Returns false where it is none, or its values are not
/// within int32.
bool iio_parse_type(const char *text, iio_channel_t *channel);

/// Sets the channels' offsets. Returns the bytes of a scan: a multiple of its largest element.
/// The indices differ.
uint32_t iio_lay_out(iio_channel_t *channels, uint32_t count);

/// The channel's value in a scan.
int32_t iio_value(const iio_channel_t *channel, const uint8_t *scan);

#endif
