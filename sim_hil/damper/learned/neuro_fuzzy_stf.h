/// Self-tuning fuzzy model, frozen: 25 rules over displacement and velocity, times a gain that
/// follows the current.
///
///   F = force_scale k(i) u(x, v),   u = sum_r mu_r w_label(r) / max(sum_r mu_r, kLeastWeight)
///   membership: mu = max(0, 1 - 2 |in - a| / b), b the whole width of the base
///
/// Trained on line it needs the measured force; frozen it is a forward model. Source: the STF model
/// of the RD-1005-3 damper; the printed membership (1 - 2 |x - a|) / b is a slip.
#ifndef QUIESCE_NEURO_FUZZY_STF_H
#define QUIESCE_NEURO_FUZZY_STF_H

#include "input_box.h"
#include "neuro_fuzzy_stf_core.h"

namespace quiesce {

/// force_scale_N and the scales > 0; bases > 0; centres rising.
using StfParams = quiesce_stf;

class NeuroFuzzyStf final : public StaticDamper {
  public:
    /// stroke_m > 0.
    NeuroFuzzyStf(const StfParams &params, double stroke_m);

    double force_N(const DamperInput &input, const double *state, double *rates) const override;

  private:
    StfParams params_;
};

} // namespace quiesce

#endif
