#include "frame_sender.h"

#include "clock.h"

namespace quiesced {

std::int64_t send_frames(can_bus_t *bus, const can_frame_t *frames, std::uint32_t count) {
    std::int64_t demand_left_ns = 0;
    bool is_one_lost = false;
    for (std::uint32_t i = 0; bus != nullptr && i < count; ++i) {
        const bool is_taken = can_bus_send(bus, &frames[i]);
        if (frames[i].id - QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID < QUIESCE_MAX_DAMPERS) {
            is_one_lost = is_one_lost || !is_taken;
            demand_left_ns = monotonic_ns();
        }
    }
    return is_one_lost ? 0 : demand_left_ns;
}

} // namespace quiesced
