/// CRC-32 as in zlib and PNG (reflected, polynomial 0xEDB88320).
#ifndef QUIESCE_CRC32_H
#define QUIESCE_CRC32_H

#include <array>
#include <cstddef>
#include <cstdint>

namespace quiesce {

class Crc32 {
  public:
    Crc32();

    /// Appends words as little-endian bytes; two words are taken at once.
    void append(const std::uint32_t *words, std::size_t count);

    /// Of all appended so far.
    std::uint32_t value() const { return ~crc_; }

  private:
    std::array<std::array<std::uint32_t, 256>, 8> tables_{};
    std::uint32_t crc_ = 0xFFFFFFFFu;
};

/// Of these words alone.
std::uint32_t crc32_of(const std::uint32_t *words, std::size_t count);

} // namespace quiesce

#endif
