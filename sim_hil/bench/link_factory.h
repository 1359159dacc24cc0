/// Makes the link to a target by its name: one line in link_factory.cpp adds a target.
#ifndef QUIESCE_LINK_FACTORY_H
#define QUIESCE_LINK_FACTORY_H

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "controller_link.h"

namespace quiesce {

/// What the targets may need beyond their name; empty where the user gave none.
struct LinkOptions {
    std::string image_path;  ///< --image: ELF for an emulated target
    std::string plugin_path; ///< --plugin: emulator plugin that counts instructions
    std::string can_channel; ///< --can: CAN channel, linux only (channel_factory.h)
    /// --telemetry-every: ticks between two bursts of all telemetry words, 1 .. 65535; linux and
    /// mps2-uart only
    std::optional<std::int64_t> telemetry_every_ticks;
    /// --wait-s: longest wait for the first answer, 0.1 .. 3600; linux only
    std::optional<double> greeting_time_s;
};

/// Throws InputError where the target is unknown (the message lists those known) or cannot start.
std::unique_ptr<ControllerLink> make_link(const std::string &target, const LinkOptions &options);

} // namespace quiesce

#endif
