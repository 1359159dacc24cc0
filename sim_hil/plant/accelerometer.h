/// Accelerometer with its converter: acceleration in, counts out.
#ifndef QUIESCE_ACCELEROMETER_H
#define QUIESCE_ACCELEROMETER_H

#include <cstdint>

#include "noise.h"

namespace quiesce {

/// Standard gravity, m/s^2.
constexpr double kGravity_m_s2 = 9.80665;

struct AccelerometerParams {
    double full_scale_g;        ///< +-, > 0
    int bits;                   ///< of the converter, 8 .. 24
    double noise_mg;            ///< RMS of white noise in each sample, >= 0
    std::int32_t offset_counts; ///< reading at zero acceleration
};

class Accelerometer {
  public:
    Accelerometer(const AccelerometerParams &params, std::uint64_t seed);

    /// One reading: noise added, rounded to counts, saturated at +-full_scale_counts.
    std::int32_t sample_counts(double accel_m_s2);

    std::int32_t full_scale_counts() const { return full_scale_counts_; }

    /// Acceleration of one count.
    double scale_m_s2() const { return scale_m_s2_; }

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive) { noise_.visit_state(archive); }

  private:
    double scale_m_s2_;
    double noise_counts_;
    std::int32_t offset_counts_;
    std::int32_t full_scale_counts_;
    Noise noise_;
};

} // namespace quiesce

#endif
