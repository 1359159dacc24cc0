/// Names of the words of a reply: telemetry fields by their C names.
#ifndef QUIESCE_REPLY_FIELDS_H
#define QUIESCE_REPLY_FIELDS_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "firmware.h"

namespace quiesce {

struct WordField {
    std::string name;
    bool is_signed;
};

/// Every 32-bit word of lockstep_reply_t in memory order. What there is several of has its number
/// at the end of its name: current_cmd_mA1, body0_accel_um_s2.
const std::vector<WordField> &reply_fields();

/// Word number index (< sizeof object / 4) of a structure of 32-bit words.
template <typename Words>
std::uint32_t word_of(const Words &words, std::size_t index) {
    std::uint32_t word = 0;
    std::memcpy(&word, reinterpret_cast<const unsigned char *>(&words) + 4 * index, 4);
    return word;
}

} // namespace quiesce

#endif
