/// An image that runs by itself to its end, counted: benchmarks on the emulated target.
#ifndef QUIESCE_IMAGE_RUN_H
#define QUIESCE_IMAGE_RUN_H

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "controller_link.h"
#include "qemu_options.h"

namespace quiesce {

struct ImageRun {
    InstructionCounts counts;                       ///< a "tick" is a pass from begin to end marker
    std::map<std::uint32_t, std::uint64_t> profile; ///< see InstructionCounter::read_profile
    std::map<std::string, std::uint32_t> printed;   ///< lines "name 0xVALUE"
};

/// Runs the image with these words at MAILBOX_BASE, or with the bytes of a file there. Throws
/// InputError when there are both, when the file is none or too large, when the image cannot run,
/// prints anything else, ends with another exit code than 0, not within options.answer_time, or
/// without a pass.
ImageRun run_image(const QemuOptions &options, const std::vector<std::uint32_t> &words,
                   const std::string &data_path = "");

} // namespace quiesce

#endif
