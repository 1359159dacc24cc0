/// When a bus counts as a failure of the drivers on it: what they are told does not reach them.
#ifndef QUIESCED_BUS_WATCH_H
#define QUIESCED_BUS_WATCH_H

#include <cstdint>

#include "firmware.h"

namespace quiesced {

class BusWatch {
  public:
    /// Of a bus that is down. One that is off has had no listener for a while when it says so: it
    /// counts at once.
    static constexpr std::int64_t kPatience_ns = 100'000'000;

    /// Once a tick. Before the bus was up for the first time it does not count: no driver has been
    /// told anything.
    void look(can_bus_state_t state, std::int64_t now_ns) {
        takes_frames_ = state == CAN_BUS_UP || state == CAN_BUS_PASSIVE;
        if (takes_frames_) {
            was_up_ = true;
            up_ns_ = now_ns;
        }
        has_failed_ =
            !takes_frames_ && was_up_ && (state == CAN_BUS_OFF || now_ns - up_ns_ >= kPatience_ns);
    }

    bool has_failed() const { return has_failed_; }
    bool takes_frames() const { return takes_frames_; }

  private:
    bool was_up_ = false;
    bool takes_frames_ = false;
    bool has_failed_ = false;
    std::int64_t up_ns_ = 0; ///< last time
};

} // namespace quiesced

#endif
