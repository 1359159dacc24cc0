/// The clock of every deadline of a link.
#ifndef QUIESCE_LINK_CLOCK_H
#define QUIESCE_LINK_CLOCK_H

#include <chrono>

namespace quiesce {

using LinkClock = std::chrono::steady_clock;

} // namespace quiesce

#endif
