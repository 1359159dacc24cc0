/// Shaker: force amplitude for a drive voltage, falling with frequency like a first-order low-pass.
///
///   force = gain_N_V sqrt((1 + (ref/corner)^2) / (1 + (f/corner)^2)) per volt
#ifndef QUIESCE_SHAKER_H
#define QUIESCE_SHAKER_H

#include <cmath>

namespace quiesce {

struct ShakerParams {
    double gain_N_V;    ///< at ref_freq_Hz
    double ref_freq_Hz; ///< > 0
    double corner_Hz;   ///< roll-off; 0: force independent of frequency
    double drive_V;     ///< amplitude of the drive, >= 0
};

class Shaker {
  public:
    explicit Shaker(const ShakerParams &params)
        : params_(params), inv_corner_s_(params.corner_Hz > 0.0 ? 1.0 / params.corner_Hz : 0.0) {
        const double ref = params.ref_freq_Hz * inv_corner_s_;
        flat_ratio_ = std::sqrt(1.0 + ref * ref);
    }

    /// Force amplitude at this frequency.
    double amplitude_N(double freq_Hz) const { return amplitude_N(freq_Hz, params_.drive_V); }

    /// The same for a drive of its own.
    double amplitude_N(double freq_Hz, double drive_V) const {
        const double ratio = freq_Hz * inv_corner_s_;
        return drive_V * params_.gain_N_V * flat_ratio_ / std::sqrt(1.0 + ratio * ratio);
    }

  private:
    ShakerParams params_;
    double inv_corner_s_;
    double flat_ratio_ = 1.0; ///< force far below the corner over force at ref_freq_Hz
};

} // namespace quiesce

#endif
