/// What tables name a board by.
#ifndef QUIESCE_BOARD_CRC_H
#define QUIESCE_BOARD_CRC_H

#include <cstdint>

#include "quiesce.h"

namespace quiesce {

/// CRC-32 of all words of the board, in the order of memory: the same in every build.
std::uint32_t board_crc32(const quiesce_board_t &board);

} // namespace quiesce

#endif
