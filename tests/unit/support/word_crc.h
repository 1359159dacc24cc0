// CRC-32 as in zlib over 32-bit words, four bits at a time. Of the tests alone: what it judges must
// not compute it.
#ifndef WORD_CRC_H
#define WORD_CRC_H

#include <stdint.h>

#define WORD_CRC_START UINT32_MAX

/// The complement of what comes out is zlib's number.
static inline uint32_t word_crc_append(uint32_t crc, uint32_t word) {
    static const uint32_t table[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4,
        0x4DB26158, 0x5005713C, 0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C,
        0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C,
    };
    crc ^= word;
    for (uint32_t i = 0; i < 8; i++) {
        crc = crc >> 4 ^ table[crc & 15u];
    }
    return crc;
}

#endif
