/// A controller that runs by itself on a CAN bus: `quiesced`, a board.
/// The plant is on its bus, as sensors, drivers and panel, and tools join by another one.
#ifndef QUIESCE_BUS_LINK_H
#define QUIESCE_BUS_LINK_H

#include <memory>
#include <string>

#include "frame_channel.h"
#include "live_link.h"
#include "multicast_bus.h"
#include "plant_frames.h"

namespace quiesce {

class BusLink final : public LiveLink {
  public:
    /// controller: leads to it. tools: none: nobody else is there.
    BusLink(std::unique_ptr<FrameChannel> controller, std::unique_ptr<MulticastBus> tools);

    std::string target() const override { return controller_->name(); }

    /// It has been started by whoever switched it on: board, parameters and tables are what tools
    /// give it. params: for the plant's rate.
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;

    /// What the controller has sent goes to the tools; its demands act from this tick on. Throws
    /// TargetGone where the line has ended.
    void look(lockstep_reply_t &reply) override;

    /// Samples that come close to the controller's tick are in some ticks twice and in others not
    /// at all: the plant keeps half a tick away. Its demands leave with its ticks, and come in the
    /// first half of the plant's or in the second.
    void half_way() override;
    std::int64_t shift_ns() override;

    /// The tick's frames of the plant, and what tools have sent, but for frames of nodes that are
    /// played here. Does not wait for the controller: the reply is what look has found. Throws
    /// TargetGone, too, where the line does not take them.
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;

    bool is_complete() const override { return false; }
    bool has_picture() const override { return false; }
    std::optional<InstructionCounts> finish() override { return std::nullopt; }
    std::int32_t tick_rate_Hz() const override { return tick_rate_Hz_; }
    void leave() override;

  private:
    void pass_on_from_tools();
    /// Returns whether a demand was there.
    bool take_from_controller();
    bool receive(can_frame_t &frame, LinkClock::time_point deadline);
    void send(const std::vector<can_frame_t> &frames);

    std::unique_ptr<FrameChannel> controller_;
    std::unique_ptr<MulticastBus> tools_;
    std::int32_t tick_rate_Hz_ = 1000;
    bool came_early_ = false; ///< in the first half of the tick
    bool came_late_ = false;
    PlantFrames plant_{tick_rate_Hz_};
};

} // namespace quiesce

#endif
