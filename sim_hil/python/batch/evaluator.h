/// Damper models over a recorded motion, many parameter sets in one call.
#ifndef QUIESCE_EVALUATOR_H
#define QUIESCE_EVALUATOR_H

#include <cstddef>
#include <string>
#include <vector>

#include "group.h"
#include "motion_grid.h"

namespace quiesce {

/// count parameter sets of one model, a row each: for every parameter of the model its orders[k]
/// coefficients against the current (1 constant, 2 linear, 3 quadratic; ascending), then the
/// kRigCount values of the rig.
struct CandidateRows {
    std::size_t model; ///< index in kernel_models()
    const int *orders;
    const double *rows;
    std::size_t count;
};

/// Numbers in a row.
std::size_t row_length(std::size_t model, const int *orders);

/// Names of the sets of instructions that this processor runs, the fastest first; the last one is
/// "scalar", one candidate at a time. All give the same bits.
std::vector<std::string> instruction_sets();

/// The set that suits this many candidates: the narrowest that takes all of them at once, since a
/// group costs the same when some of its lanes are idle; else the fastest.
std::string set_for(std::size_t count);

/// Forces in N at the samples: [count][samples]. set: a name of instruction_sets(), which must
/// exist. A candidate whose integration diverges has infinities or NaN.
void simulate(const CandidateRows &candidates, const MotionGrid &motion, const std::string &set,
              double *force_N);

/// What the model's force is compared with.
struct Measured {
    const double *force_N;       ///< as many as the motion has samples
    const double *weight;        ///< of each squared error, or null
    std::size_t average_samples; ///< odd; centred moving average over the model's force (1: none)
};

/// Sum of weighted squared errors of each candidate: [count].
void squared_error(const CandidateRows &candidates, const MotionGrid &motion,
                   const Measured &measured, const std::string &set, double *error_N2);

/// Centred moving average over an odd number of samples; shorter at the ends, symmetric.
void moving_average(std::vector<double> &values, std::size_t samples);

} // namespace quiesce

#endif
