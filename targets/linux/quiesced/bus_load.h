/// How full the CAN bus of a configuration is, by the longest frames (worst-case bit stuffing) of
/// everything that comes by the clock: `quiesce can bus-load` has the same figures.
#ifndef QUIESCED_BUS_LOAD_H
#define QUIESCED_BUS_LOAD_H

#include <array>
#include <cstdint>

#include "config.h"

namespace quiesced {

/// No more than this, so that frames which are sent again have room.
constexpr double kMostLoad_pct = 80.0;
constexpr std::uint32_t kUsualBitrate = 500'000;

/// Longest frame of so many data bytes (0 .. 8) with its inter-frame space, in bits.
std::uint32_t classic_bits(std::uint32_t bytes);

/// Of a CAN FD frame with BRS: bits at the bus's bit rate, and at that of the data.
struct FdBits {
    std::uint32_t nominal;
    std::uint32_t data;
};
FdBits fd_bits(std::uint32_t bytes);

/// In percent.
struct BusLoad {
    double demands; ///< of all dampers
    double samples; ///< of sensors on the bus
    double others;
    double total() const { return demands + samples + others; }
};

/// At these parameters' tick rate: what is due more often comes once a tick. A sensor with a period
/// sends at that, another one every tick, at most every cycle of its message. Raw samples and
/// services come on request and are left out. Allocates nothing; config has a bus.
BusLoad bus_load(const Config &config, const quiesce_params_t &params);

} // namespace quiesced

#endif
