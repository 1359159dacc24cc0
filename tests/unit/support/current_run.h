/// The current loop that ships on a simulated coil: full-scale steps, and what they came to.
#ifndef CURRENT_RUN_H
#define CURRENT_RUN_H

#include <vector>

#include "coil_circuit.h"
#include "current_loop.h"

namespace quiesce {

constexpr double LOOP_STEP_S = 1.0 / CURRENT_LOOP_HZ;
constexpr double BAND = 0.05; ///< of a step: within it, it has arrived

/// One set of gains for every coil; 5 ohm are nominal, full scale is 2 A.
current_loop_cfg_t shipped_loop(bool is_full_bridge);

/// Loop and coil in lock-step: a duty acts one step after the sample that it is of.
class CurrentRun {
  public:
    CurrentRun(const CoilCircuitParams &coil, std::uint64_t seed);

    void command(std::int32_t command_mA) { current_loop_command(&loop, command_mA); }
    void step();
    void steps(int count);

    current_loop_t loop{};
    CoilCircuit coil;

  private:
    std::int32_t duty_ = 0;
};

/// A step from 0 to full scale.
struct CurrentStep {
    double time_ms = 0.0;       ///< until it is within BAND for good
    double bound_ms = 0.0;      ///< until full duty is: who knew the coil could do no better
    double overshoot_pct = 0.0; ///< of the step
    double steady_pct = 0.0;    ///< error of the mean, later on
    bool is_possible = false;   ///< the supply carries full scale
};

CurrentStep full_scale_step(const CoilCircuitParams &coil, std::uint64_t seed);

/// Coils and supplies that the loop is for: 5 ohm +-30 %, 20 .. 200 mH, 12 and 24 V.
std::vector<CoilCircuitParams> all_coils();

} // namespace quiesce

#endif
