#include "link_factory.h"

#include <chrono>
#include <cmath>

#include "can_link.h"
#include "channel_factory.h"
#include "in_process_link.h"
#include "input_error.h"
#include "qemu_shm_link.h"
#include "qemu_uart_link.h"

namespace quiesce {

namespace {

struct Target {
    const char *name;
    std::unique_ptr<ControllerLink> (*make)(const LinkOptions &options);
};

void refuse(bool is_given, const char *option, const char *why) {
    if (is_given) {
        throw InputError(std::string(option) + ": " + why);
    }
}

void refuse_channel(const LinkOptions &options) {
    constexpr const char *kWhy = "only --target linux is driven over a CAN channel";
    refuse(!options.can_channel.empty(), "--can", kWhy);
    refuse(options.greeting_time_s.has_value(), "--wait-s", kWhy);
}

void refuse_telemetry(const LinkOptions &options) {
    refuse(options.telemetry_every_ticks.has_value(), "--telemetry-every",
           "only --target linux and mps2-uart are driven by CAN messages");
}

TelemetryRate telemetry(const LinkOptions &options) {
    TelemetryRate out = kFullTelemetry;
    if (options.telemetry_every_ticks) {
        out.every_ticks = static_cast<std::uint16_t>(*options.telemetry_every_ticks);
    }
    return out;
}

QemuOptions emulated(const LinkOptions &options) {
    refuse_channel(options);
    if (options.image_path.empty()) {
        throw InputError(
            "an emulated target needs --image ELF; cmake --preset mps2 && cmake --build "
            "--preset mps2 makes build/mps2/targets/mps2/quiesce_mps2_shm.elf (mps2) and "
            "quiesce_mps2_uart.elf (mps2-uart)");
    }
    QemuOptions out;
    out.image_path = options.image_path;
    out.plugin_path = options.plugin_path;
    return out;
}

std::unique_ptr<ControllerLink> make_linux(const LinkOptions &options) {
    refuse(!options.image_path.empty(), "--image", "--target linux runs no image");
    refuse(!options.plugin_path.empty(), "--plugin", "--target linux runs no image");
    if (options.can_channel.empty()) {
        throw InputError("--target linux needs --can CHANNEL, what leads to quiesced --lockstep: "
                         "slcan:/dev/pts/5, slcan:unix:PATH, slcan:tcp:HOST:PORT or "
                         "socketcan:can0");
    }
    CanLinkOptions out;
    out.telemetry = telemetry(options);
    if (options.greeting_time_s) {
        out.greeting_time = std::chrono::milliseconds(std::lround(1e3 * *options.greeting_time_s));
    }
    return std::make_unique<CanLink>(open_channel(options.can_channel), out);
}

const Target kTargets[] = {
    {"host",
     [](const LinkOptions &options) -> std::unique_ptr<ControllerLink> {
         refuse_channel(options);
         refuse_telemetry(options);
         return std::make_unique<InProcessLink>();
     }},
    {"mps2",
     [](const LinkOptions &options) -> std::unique_ptr<ControllerLink> {
         refuse_telemetry(options);
         return std::make_unique<QemuShmLink>(emulated(options));
     }},
    {"mps2-uart",
     [](const LinkOptions &options) -> std::unique_ptr<ControllerLink> {
         return std::make_unique<QemuUartLink>(emulated(options), telemetry(options));
     }},
    {"linux", make_linux},
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
