/// White Gaussian noise that is the same for the same seed, whatever the C++ library.
#ifndef QUIESCE_NOISE_H
#define QUIESCE_NOISE_H

#include <cstdint>

#include "state_archive.h"

namespace quiesce {

/// Generator: xoshiro256++ (Blackman and Vigna), seeded through SplitMix64. Distribution:
/// Marsaglia's polar method. Nothing comes from the C++ library's distributions, whose results
/// vary.
class Noise {
  public:
    explicit Noise(std::uint64_t seed);

    /// Next 64 random bits.
    std::uint64_t bits();

    /// Next sample of mean 0 and variance 1.
    double gaussian();

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive) {
        archive(state_);
        archive(spare_);
        archive(has_spare_);
    }

  private:
    double uniform_signed();

    std::uint64_t state_[4];
    double spare_ = 0.0;
    bool has_spare_ = false;
};

} // namespace quiesce

#endif
