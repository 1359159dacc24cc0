#include "lockstep_mode.h"

#include <array>
#include <cstdio>
#include <memory>

#include <poll.h>

#include "bus.h"
#include "clock.h"
#include "read_config.h"
#include "signals.h"

extern "C" {
#include "lockstep_can.h"
}

namespace quiesced {

namespace {

constexpr int kPatience_ms = 1000;
constexpr int kLongestWait_ms = 100; // a lost bus is looked for again after it

/// Sends the replies in their order; what the bus does not take within a second is lost, and the
/// bench will say so.
void answer(can_bus_t *bus, lockstep_can_t &server, const can_frame_t &frame) {
    std::array<can_frame_t, LOCKSTEP_CAN_MAX_REPLIES> replies;
    const std::uint32_t count = lockstep_can_receive(&server, &frame, replies.data());
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!send_patiently(bus, replies[i], kPatience_ms)) {
            (void)std::fprintf(stderr, "quiesced: CAN: a reply was not taken\n");
        }
    }
}

void wait_for_frames(can_bus_t *bus) {
    pollfd ready = {can_bus_fd(bus), POLLIN, 0};
    (void)poll(&ready, 1, kLongestWait_ms);
    can_bus_repair(bus, monotonic_ns());
}

void serve(can_bus_t *bus, lockstep_can_t &server) {
    can_frame_t frame{};
    lockstep_can_greet(&server, &frame);
    (void)send_patiently(bus, frame, kPatience_ms);
    while (!server.is_stopped && !stop_is_requested()) {
        wait_for_frames(bus);
        while (!server.is_stopped && can_bus_receive(bus, &frame, nullptr)) {
            answer(bus, server, frame);
        }
    }
}

} // namespace

int run_lockstep(const std::string &config_file) {
    const Config config = require_config(config_file, Needs::bus_only);
    install_signals();
    take_signals(-1);
    const Bus bus = open_bus(*config.can, BusUse::lockstep);
    const auto server = std::make_unique<lockstep_can_t>();
    lockstep_can_init(server.get());
    serve(bus.get(), *server);
    return 0;
}

} // namespace quiesced
