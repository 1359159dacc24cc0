/// Instruction counts of an image: the counting plugin's options for QEMU, and what it reports.
#ifndef QUIESCE_INSTRUCTION_COUNTER_H
#define QUIESCE_INSTRUCTION_COUNTER_H

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "controller_link.h"
#include "file_descriptor.h"
#include "qemu_options.h"

namespace quiesce {

class InstructionCounter {
  public:
    /// Throws InputError when the plugin is missing or the image lacks the markers
    /// (hal/mps2/count_markers.c).
    explicit InstructionCounter(const QemuOptions &options);

    /// Options and inherited descriptors for QemuProcess; none where counting is off.
    std::vector<std::string> qemu_arguments() const;
    std::vector<int> inherited() const;

    /// Counts of all control ticks, once QEMU has ended. Nothing iff counting is off or no tick
    /// ran.
    std::optional<InstructionCounts> read() const;

    /// The same instructions by the address where their block begins, once QEMU has ended. Empty
    /// where QemuOptions::profile is off.
    std::map<std::uint32_t, std::uint64_t> read_profile() const;

  private:
    std::string plugin_argument_; ///< empty: counting is off
    FileDescriptor report_;
};

} // namespace quiesce

#endif
