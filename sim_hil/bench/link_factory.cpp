#include "link_factory.h"

#include "in_process_link.h"
#include "input_error.h"

namespace quiesce {

namespace {

struct Target {
    const char *name;
    std::unique_ptr<ControllerLink> (*make)(const LinkOptions &options);
};

const Target kTargets[] = {
    {"host",
     [](const LinkOptions &) -> std::unique_ptr<ControllerLink> {
         return std::make_unique<InProcessLink>();
     }},
};

std::string known_targets() {
    std::string names;
    for (const Target &target : kTargets) {
        names += (names.empty() ? "" : ", ") + std::string(target.name);
    }
    return names;
}

} // namespace

std::unique_ptr<ControllerLink> make_link(const std::string &target, const LinkOptions &options) {
    for (const Target &known : kTargets) {
        if (target == known.name) {
            return known.make(options);
        }
    }
    throw InputError("--target " + target + ": unknown target; choose one of: " + known_targets());
}

} // namespace quiesce
