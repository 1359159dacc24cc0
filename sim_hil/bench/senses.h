/// What the controller's sensors deliver of a plant, tick by tick.
#ifndef QUIESCE_SENSES_H
#define QUIESCE_SENSES_H

#include <cstdint>
#include <optional>
#include <vector>

#include "accelerometer.h"
#include "delay_line.h"
#include "firmware.h"
#include "noise.h"
#include "plant.h"
#include "rig.h"

namespace quiesce {

/// One sensor of a board: scale, offset, polarity, full scale, rate, latency and noise.
class BoardSensor {
  public:
    /// seed: of its noise.
    BoardSensor(const Rig &rig, std::size_t index, std::int32_t tick_rate_Hz, std::uint64_t seed);

    /// Takes what it measures in this tick. Returns true, with its counts, iff a sample is due.
    bool sample(const Plant &plant, std::int64_t tick, std::int32_t &counts);

    std::int32_t full_scale_counts() const { return spec_.full_scale_counts; }

    /// Gravity along its axis, where it is an accelerometer.
    void lie(double gravity_m_s2);

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive);

  private:
    double measure(const Plant &plant, std::size_t source) const;
    double shown(const Plant &plant);
    bool is_due(std::int64_t tick) const;

    quiesce_board_sensor_t spec_;
    std::size_t source_; ///< place or damper of the plant
    double noise_counts_;
    std::int64_t tick_rate_Hz_;
    double gravity_ = 0.0;                   ///< in the unit of the board
    std::optional<SensorDynamics> dynamics_; ///< none: it is ideal
    std::size_t other_;                      ///< place or damper that it sees, too
    DelayLine<double> latency_;
    Noise noise_;
};

/// All of them; without a rig the plant's own accelerometer.
class Senses {
  public:
    Senses(const PlantModel &plant, const Rig *rig, std::int32_t tick_rate_Hz, std::uint64_t seed);

    /// Writes counts and flags of fresh samples.
    void read(const Plant &plant, std::int64_t tick, lockstep_stimulus_t &out);

    /// What every accelerometer reads of gravity along its axis from now on: at first 0, +-g where
    /// somebody has turned it over.
    void lie(double gravity_m_s2);

    /// Of each sensor.
    std::vector<std::int32_t> full_scales() const;

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive);

  private:
    double own_accel_m_s2(const Plant &plant);

    double gravity_m_s2_ = 0.0;
    Accelerometer own_;
    std::optional<SensorDynamics> transducer_; ///< of the plant's own; none: it is ideal
    std::optional<std::size_t> other_;         ///< place that it sees, too
    std::vector<BoardSensor> sensors_;         ///< none without a rig
};

} // namespace quiesce

#endif
