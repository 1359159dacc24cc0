/// How a weighted sum of a plant's rates and damper forces changes with its state and currents: one
/// product with the transposed Jacobian of Equations::rates.
///
/// The structure's part is exact; that of dampers and mounts by central differences over a small
/// part of what each value has reached, so that every model of a damper has it.
#ifndef QUIESCE_RATES_PULLBACK_H
#define QUIESCE_RATES_PULLBACK_H

#include <cstddef>
#include <vector>

#include "plant_model.h"

namespace quiesce {

/// The largest magnitudes that a motion has reached.
struct Reached {
    std::vector<double> state;     ///< of eta, eta', dampers' states
    std::vector<double> stroke_m;  ///< of each damper, then of each mount
    std::vector<double> speed_m_s; ///< likewise
};

/// Where slopes are taken.
struct PullbackPlace {
    const Reached &reached;
    const std::vector<double> &y; ///< [state_count]
    const DamperValues &current_A;
};

/// The sum whose slopes are taken: its weights.
struct PullbackWeights {
    const std::vector<double> &rates; ///< [state_count]
    const DamperValues &force;        ///< of the dampers
};

/// Its slopes, which are added to.
struct PullbackSlopes {
    std::vector<double> &state; ///< [state_count]
    DamperValues &current;
};

class RatesPullback {
  public:
    explicit RatesPullback(const PlantModel &model);

    std::size_t state_count() const { return state_count_; }

    /// Nothing yet.
    Reached nothing_reached() const;
    /// Widens what is reached by state y.
    void reach(const std::vector<double> &y, Reached &reached) const;

    void add(const PullbackPlace &at, const PullbackWeights &of, const PullbackSlopes &slopes);

  private:
    void add_structure(const std::vector<double> &of_rates, std::vector<double> &of_state) const;
    void add_mount(const PlantMount &one, double stroke_step_m, double speed_step_m_s,
                   const std::vector<double> &y, const std::vector<double> &of_rates,
                   std::vector<double> &of_state) const;
    void add_damper(std::size_t k, const PullbackPlace &at, const PullbackWeights &of,
                    const PullbackSlopes &slopes);

    PlantModel model_;
    std::vector<std::size_t> first_state_; ///< of each damper, in y
    std::size_t modes_;
    std::size_t state_count_;
    std::vector<double> state_; ///< of one damper, and its rates
    std::vector<double> rates_;
};

} // namespace quiesce

#endif
