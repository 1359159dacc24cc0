#include "board_crc.h"

#include <array>
#include <cstring>

#include "crc32.h"

namespace quiesce {

std::uint32_t board_crc32(const quiesce_board_t &board) {
    static_assert(sizeof board % sizeof(std::uint32_t) == 0, "a board is words");
    std::array<std::uint32_t, sizeof board / sizeof(std::uint32_t)> words;
    std::memcpy(words.data(), &board, sizeof board);
    return crc32_of(words.data(), words.size());
}

} // namespace quiesce
