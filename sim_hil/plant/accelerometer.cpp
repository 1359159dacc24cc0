#include "accelerometer.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

Accelerometer::Accelerometer(const AccelerometerParams &params, std::uint64_t seed)
    : scale_m_s2_(params.full_scale_g * kGravity_m_s2 /
                  static_cast<double>(1 << (params.bits - 1))),
      noise_counts_(params.noise_mg * 1e-3 * kGravity_m_s2 / scale_m_s2_),
      offset_counts_(params.offset_counts), full_scale_counts_((1 << (params.bits - 1)) - 1),
      noise_(seed) {}

std::int32_t Accelerometer::sample_counts(double accel_m_s2) {
    const double counts = accel_m_s2 / scale_m_s2_ + noise_counts_ * noise_.gaussian() +
                          static_cast<double>(offset_counts_);
    const double limit = static_cast<double>(full_scale_counts_);
    return static_cast<std::int32_t>(std::floor(std::clamp(counts, -limit, limit) + 0.5));
}

} // namespace quiesce
