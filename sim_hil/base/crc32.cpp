#include "crc32.h"

namespace quiesce {

Crc32::Crc32() {
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t crc = byte;
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc & 1u) != 0 ? (crc >> 1) ^ 0xEDB88320u : crc >> 1;
        }
        tables_[0][byte] = crc;
    }
    for (std::size_t ahead = 1; ahead < tables_.size(); ++ahead) {
        for (std::size_t byte = 0; byte < 256; ++byte) {
            const std::uint32_t before = tables_[ahead - 1][byte];
            tables_[ahead][byte] = (before >> 8) ^ tables_[0][before & 0xFFu];
        }
    }
}

void Crc32::append(const std::uint32_t *words, std::size_t count) {
    std::size_t i = 0;
    for (; i + 1 < count; i += 2) {
        const std::uint32_t low = crc_ ^ words[i];
        const std::uint32_t high = words[i + 1];
        crc_ = tables_[7][low & 0xFFu] ^ tables_[6][(low >> 8) & 0xFFu] ^
               tables_[5][(low >> 16) & 0xFFu] ^ tables_[4][low >> 24] ^ tables_[3][high & 0xFFu] ^
               tables_[2][(high >> 8) & 0xFFu] ^ tables_[1][(high >> 16) & 0xFFu] ^
               tables_[0][high >> 24];
    }
    if (i < count) {
        const std::uint32_t low = crc_ ^ words[i];
        crc_ = tables_[3][low & 0xFFu] ^ tables_[2][(low >> 8) & 0xFFu] ^
               tables_[1][(low >> 16) & 0xFFu] ^ tables_[0][low >> 24];
    }
}

std::uint32_t crc32_of(const std::uint32_t *words, std::size_t count) {
    Crc32 crc;
    crc.append(words, count);
    return crc.value();
}

} // namespace quiesce
