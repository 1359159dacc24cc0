/// What an operator asks of a controller: how much does it vibrate with it, and how much without?
#ifndef QUIESCE_VIBRATION_H
#define QUIESCE_VIBRATION_H

#include <cstddef>
#include <deque>
#include <optional>

#include "run.h"

namespace quiesce {

struct VibrationRms {
    double displacement_m; ///< at the sensor, relative to the base
    double accel_m_s2;     ///< at the sensor, absolute
};

/// True RMS over the last seconds with control on, and likewise off.
class Vibration final : public TickObserver {
  public:
    /// Length of the window; it begins anew with every change.
    static constexpr double kWindow_s = 2.0;

    explicit Vibration(std::int64_t tick_rate_Hz);

    void on_tick(const TickRecord &record) override;

    /// Control goes on or off: what was measured before stays for the comparison.
    void control(bool is_on);

    /// It is shaken otherwise: what was measured before compares with nothing any more.
    void excitation_changed();

    /// None until a whole window has passed.
    const std::optional<VibrationRms> &on() const { return on_; }
    const std::optional<VibrationRms> &off() const { return off_; }
    /// Of the window that is under way: a part of one, too.
    VibrationRms now() const;

  private:
    struct Sums {
        double displacement_m2 = 0.0;
        double accel_m2_s4 = 0.0;
    };

    static constexpr std::size_t kBlocks = 20;

    void close_block();

    std::int64_t block_ticks_;
    std::int64_t ticks_ = 0; ///< in the block under way
    Sums block_;
    std::deque<Sums> blocks_; ///< whole ones, at most kBlocks
    bool is_on_ = true;
    std::optional<VibrationRms> on_;
    std::optional<VibrationRms> off_;
};

} // namespace quiesce

#endif
