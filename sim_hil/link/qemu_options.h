/// What every emulated target is made from.
#ifndef QUIESCE_QEMU_OPTIONS_H
#define QUIESCE_QEMU_OPTIONS_H

#include <chrono>
#include <string>

namespace quiesce {

struct QemuOptions {
    std::string image_path;
    /// Instruction counter; empty: the one beside this program; "none": do not count.
    std::string plugin_path;
    /// Count each instruction by itself instead of whole blocks: slower, the check on the fast way.
    bool count_each_instruction = false;
    /// Count also where in the image the instructions are, in all ticks ("all") or in one (its
    /// number, from 1): slower.
    std::string profile = "off";
    /// Longest wait for one answer. Generous: a loaded machine must not look like a dead target.
    std::chrono::milliseconds answer_time = std::chrono::seconds(10);
};

/// QEMU splits option values at commas; a doubled one stands for itself.
inline std::string escape_commas(const std::string &path) {
    std::string out;
    for (const char c : path) {
        out += c == ',' ? std::string(",,") : std::string(1, c);
    }
    return out;
}

} // namespace quiesce

#endif
