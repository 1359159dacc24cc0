/// The CAN bus of a configuration, closed by its owner's end.
#ifndef QUIESCED_BUS_H
#define QUIESCED_BUS_H

#include <memory>

#include "config.h"

namespace quiesced {

struct BusCloser {
    void operator()(can_bus_t *bus) const { can_bus_close(bus); }
};
using Bus = std::unique_ptr<can_bus_t, BusCloser>;

/// Whose messages are received.
enum class BusUse { controller, lockstep };

/// Throws InputError: "can.interface: what, and what to do".
Bus open_bus(const CanConfig &config, BusUse use);

/// Sends a frame to a bus that takes it within some time, and repairs it meanwhile. Blocks: not for
/// the control loop.
/// Returns false iff the bus does not take it.
bool send_patiently(can_bus_t *bus, const can_frame_t &frame, int patience_ms);

} // namespace quiesced

#endif
