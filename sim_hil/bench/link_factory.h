/// Makes the link to a target by its name: one line in link_factory.cpp adds a target.
#ifndef QUIESCE_LINK_FACTORY_H
#define QUIESCE_LINK_FACTORY_H

#include <memory>
#include <string>

#include "controller_link.h"

namespace quiesce {

/// What the targets may need beyond their name; empty where the user gave none.
struct LinkOptions {
    std::string image_path;       ///< --image: ELF for an emulated target
    std::string plugin_path;      ///< --plugin: emulator plugin that counts instructions
    std::string rules_path;       ///< --rules: rule table for the controller, host only
    std::string phase_table_path; ///< --phase-table: table of pulses, host only
};

/// Throws InputError where the target is unknown (the message lists those known) or cannot start.
std::unique_ptr<ControllerLink> make_link(const std::string &target, const LinkOptions &options);

} // namespace quiesce

#endif
