#include "link_factory.h"

#include "in_process_link.h"
#include "input_error.h"
#include "phase_table_file.h"
#include "qemu_shm_link.h"
#include "qemu_uart_link.h"
#include "rule_file.h"

namespace quiesce {

namespace {

struct Target {
    const char *name;
    std::unique_ptr<ControllerLink> (*make)(const LinkOptions &options);
};

QemuOptions emulated(const LinkOptions &options) {
    if (!options.rules_path.empty()) {
        throw InputError("--rules: only the host target takes a rule table");
    }
    if (!options.phase_table_path.empty()) {
        throw InputError("--phase-table: only the host target takes a table of pulses");
    }
    if (options.image_path.empty()) {
        throw InputError(
            "an emulated target needs --image ELF; cmake --preset mps2 && cmake --build "
            "--preset mps2 makes build/mps2/hal/quiesce_mps2_shm.elf (mps2) and "
            "quiesce_mps2_uart.elf (mps2-uart)");
    }
    QemuOptions out;
    out.image_path = options.image_path;
    out.plugin_path = options.plugin_path;
    return out;
}

const Target kTargets[] = {
    {"host",
     [](const LinkOptions &options) -> std::unique_ptr<ControllerLink> {
         InProcessLink::Tables tables;
         if (!options.rules_path.empty()) {
             tables.rules = load_rules(options.rules_path);
         }
         if (!options.phase_table_path.empty()) {
             tables.phase = load_phase_table(options.phase_table_path);
         }
         return std::make_unique<InProcessLink>(std::move(tables));
     }},
    {"mps2",
     [](const LinkOptions &options) -> std::unique_ptr<ControllerLink> {
         return std::make_unique<QemuShmLink>(emulated(options));
     }},
    {"mps2-uart",
     [](const LinkOptions &options) -> std::unique_ptr<ControllerLink> {
         return std::make_unique<QemuUartLink>(emulated(options), kFullTelemetry);
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
