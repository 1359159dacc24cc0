/// What is around a controller, as nodes of its CAN bus (quiesce.dbc): sensors, drivers of dampers,
/// the operator's panel and the emergency stop.
#ifndef QUIESCE_PLANT_FRAMES_H
#define QUIESCE_PLANT_FRAMES_H

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware.h"
#include "firmware_comm.h"

namespace quiesce {

/// A row's message (QUIESCE_CAN_AT_..) without data yet.
can_frame_t empty_frame(std::size_t message);

class PlantFrames {
  public:
    /// tick_rate_Hz: of the plant. Messages keep their own cycle where that is slower.
    explicit PlantFrames(std::int32_t tick_rate_Hz);

    /// Frames of the next tick, for what a controller sees in it; those that are not due are left
    /// out. A count beyond its 24 bits is the nearest one, marked saturated. With LOCKSTEP_LOST
    /// there are none.
    std::vector<can_frame_t> of_tick(const lockstep_stimulus_t &stimulus);

    /// The panel lets the enable go, at once.
    can_frame_t release();

    /// Whether a frame is of a node that is played here: it would be a second one of it.
    static bool is_ours(const can_frame_t &frame);

    /// A frame of the controller. What is damaged or none of what drivers and panel look at is
    /// passed over.
    void take(const can_frame_t &frame);

    /// What the drivers do after this tick, and what the controller has told of itself. A driver
    /// that has had no demand for its timeout is off, as it is before the first one.
    void answer(lockstep_reply_t &reply) const;

  private:
    /// Of a message: its counter, and ticks until it may come again.
    struct Sender {
        std::uint8_t alive = 0;
        std::int32_t wait_ticks = 0;
    };
    struct Driver {
        std::int32_t current_cmd_mA = 0;
        bool is_enabled = false;
        std::int32_t age_ticks = 0;
        bool has_demand = false;
    };

    std::int32_t ticks_of(std::uint32_t time_ms) const;
    bool is_due(std::size_t message);
    void protect(std::size_t message, can_frame_t &frame);
    void put_current(const lockstep_stimulus_t &stimulus, std::size_t damper,
                     std::vector<can_frame_t> &frames);
    void put_sample(const lockstep_stimulus_t &stimulus, std::size_t number,
                    std::vector<can_frame_t> &frames);
    void put_operator(const lockstep_stimulus_t &stimulus, std::vector<can_frame_t> &frames);
    void put_stop(const lockstep_stimulus_t &stimulus, std::vector<can_frame_t> &frames);
    can_frame_t panel(bool is_enabled, bool is_reset);
    void take_demand(std::size_t damper, const can_frame_t &frame);
    void take_status(const can_frame_t &frame);

    std::int32_t tick_rate_Hz_;
    std::array<Sender, QUIESCE_CAN_MESSAGES> senders_{};
    std::array<Driver, QUIESCE_MAX_DAMPERS> drivers_{};
    std::bitset<QUIESCE_MAX_SENSORS> is_fresh_; ///< since the sensor's last frame
    std::int32_t panel_frames_ = 0;             ///< sent, as far as that matters
    std::int32_t resets_ = 0;                   ///< frames in which the reset is still pressed
    bool was_reset_ = false;
    quiesce_telemetry_t told_{};
};

} // namespace quiesce

#endif
