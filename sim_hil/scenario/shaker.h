/// Shaker: what a drive voltage gives, falling with frequency like a first-order low-pass: a force,
/// or, of a table on which the structure stands, an acceleration of its base.
///
///   amplitude = gain sqrt((1 + (ref/corner)^2) / (1 + (f/corner)^2)) per volt
#ifndef QUIESCE_SHAKER_H
#define QUIESCE_SHAKER_H

#include <cmath>

#include "segment.h"

namespace quiesce {

struct ShakerParams {
    double gain_per_V;  ///< at ref_freq_Hz: N/V, or m/s2 per V where it moves the base
    double ref_freq_Hz; ///< > 0
    double corner_Hz;   ///< roll-off; 0: independent of frequency
    double drive_V;     ///< amplitude of the drive, >= 0
    bool moves_base = false;
};

class Shaker {
  public:
    explicit Shaker(const ShakerParams &params)
        : params_(params), inv_corner_s_(params.corner_Hz > 0.0 ? 1.0 / params.corner_Hz : 0.0) {
        const double ref = params.ref_freq_Hz * inv_corner_s_;
        flat_ratio_ = std::sqrt(1.0 + ref * ref);
    }

    /// Amplitude at this frequency, in N or m/s2.
    double amplitude(double freq_Hz) const { return amplitude(freq_Hz, params_.drive_V); }

    /// The same for a drive of its own.
    double amplitude(double freq_Hz, double drive_V) const {
        const double ratio = freq_Hz * inv_corner_s_;
        return drive_V * params_.gain_per_V * flat_ratio_ / std::sqrt(1.0 + ratio * ratio);
    }

    /// What acts where the shaker gives this value, in N or m/s2.
    ExcitationSample sample(double value, double freq_Hz, double phase_cycles) const {
        const bool is_base = params_.moves_base;
        return {is_base ? 0.0 : value, freq_Hz, phase_cycles, is_base ? value : 0.0};
    }

  private:
    ShakerParams params_;
    double inv_corner_s_;
    double flat_ratio_ = 1.0; ///< far below the corner over that at ref_freq_Hz
};

} // namespace quiesce

#endif
