#include "frame_sender.h"

#include "clock.h"

namespace quiesced {

std::int64_t send_frames(can_bus_t *bus, const can_frame_t *frames, std::uint32_t count) {
    std::int64_t demand_left_ns = 0;
    for (std::uint32_t i = 0; bus != nullptr && i < count; ++i) {
        const bool is_taken = can_bus_send(bus, &frames[i]);
        if (is_taken && frames[i].id == QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID) {
            demand_left_ns = monotonic_ns();
        }
    }
    return demand_left_ns;
}

} // namespace quiesced
