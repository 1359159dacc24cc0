/// Values on their way: of a bus, of a sensor.
#ifndef QUIESCE_DELAY_LINE_H
#define QUIESCE_DELAY_LINE_H

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "state_archive.h"

namespace quiesce {

/// Whole ticks, halves away from 0. time_us: from 0 on.
inline std::size_t ticks_in(std::int32_t time_us, std::int64_t tick_rate_Hz) {
    return static_cast<std::size_t>(
        std::llround(time_us * static_cast<double>(tick_rate_Hz) / 1e6));
}

/// What goes in comes out that many ticks later; before it, what there is at rest.
template <typename T>
class DelayLine {
  public:
    explicit DelayLine(std::size_t ticks = 0, const T &at_rest = {}) : values_(ticks, at_rest) {}

    /// Once a tick.
    T pass(const T &value) {
        values_.push_back(value);
        const T out = values_.front();
        values_.pop_front();
        return out;
    }

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive) { archive(values_); }

  private:
    std::deque<T> values_; ///< the oldest first
};

} // namespace quiesce

#endif
