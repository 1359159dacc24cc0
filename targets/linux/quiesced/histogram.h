/// Histograms of the loop's times, for logs and the status file.
#ifndef QUIESCED_HISTOGRAM_H
#define QUIESCED_HISTOGRAM_H

#include <cstdint>
#include <string>

#include "firmware.h"

namespace quiesced {

/// "10000 ticks, mean 12.3 us, worst 187 us; <8us 120, <16us 9800, <256us 80": bins that are empty
/// are left out.
std::string histogram_line(const tick_histogram_t &histogram);

/// {"count": .., "mean_us": .., "worst_us": .., "below_us": {"8": 120, ...}}
std::string histogram_json(const tick_histogram_t &histogram);

} // namespace quiesced

#endif
