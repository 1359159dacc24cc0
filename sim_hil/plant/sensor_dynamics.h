/// What a sensor makes of a quantity before it is sampled: band, corner, drift and cross-talk.
///
///   what it sees = value + cross_talk other + cross_talk_per_A coil_A
///   band         first-order low-pass, -3 dB at band_Hz
///   corner       first-order high-pass, -3 dB at corner_Hz: phases lead by atan(corner / f)
///   drift        a Gauss-Markov offset, from 0 at the start
///
/// Between ticks the quantity is taken as a straight line; for it the filters are exact.
#ifndef QUIESCE_SENSOR_DYNAMICS_H
#define QUIESCE_SENSOR_DYNAMICS_H

#include <cstdint>
#include <optional>
#include <string>

#include "noise.h"

namespace quiesce {

/// As read from a sensor file (docs/howto/describe-a-plant.md). Numbers without a unit in their
/// name are in `unit`.
struct SensorParams {
    std::string name;
    std::string unit;        ///< um/s2, um/s, nm or mN
    double corner_Hz;        ///< >= 0; 0: none, down to a constant
    double band_Hz;          ///< >= 0; 0: no limit
    double noise;            ///< RMS of white noise in each sample, >= 0
    double drift;            ///< RMS, >= 0
    double drift_s;          ///< after which the drift has forgotten most of what it was, > 0
    double cross_talk;       ///< part of the same quantity elsewhere
    double cross_talk_per_A; ///< of current in a damper's coil
};

/// A sensor of a plant.
struct WiredSensor {
    SensorParams params;
    std::string cross_talk_from; ///< place or damper; "": of none
};

/// First-order low-pass, exact for straight lines between ticks. Starts settled at its first input.
class LowPass {
  public:
    LowPass(double corner_Hz, double tick_s);
    double step(double in);

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive) {
        archive(in_);
        archive(out_);
    }

  private:
    double time_constant_s_;
    double tick_s_;
    double kept_; ///< of what it was a tick ago
    std::optional<double> in_;
    double out_ = 0.0;
};

class SensorDynamics {
  public:
    SensorDynamics(const SensorParams &params, int tick_rate_Hz, std::uint64_t seed);

    /// One tick: what it shows of value where it also sees other and a coil's current.
    double step(double value, double other, double coil_A);

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive) {
        band_.visit_state(archive);
        corner_.visit_state(archive);
        archive(drift_);
        noise_.visit_state(archive);
    }

  private:
    double drift();

    SensorParams params_;
    LowPass band_;
    LowPass corner_; ///< what is slower than the corner
    double drift_kept_;
    double drift_ = 0.0;
    Noise noise_; ///< of the drift
};

} // namespace quiesce

#endif
