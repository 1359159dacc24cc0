/// Support-vector regression with a Gaussian kernel.
///
///   F = force_scale (b + sum_j a_j exp(-gamma |u - s_j|^2)), u the inputs scaled to -1 .. 1
///
/// The temperature may be one of the inputs. Source: Shi's support-vector model with temperature.
#ifndef QUIESCE_SUPPORT_VECTOR_H
#define QUIESCE_SUPPORT_VECTOR_H

#include <vector>

#include "input_box.h"

namespace quiesce {

struct SupportVectorParams {
    double force_scale_N;                ///< > 0
    double gamma;                        ///< > 0
    double intercept;                    ///< b
    std::vector<double> coefficients;    ///< a, at least one
    std::vector<double> support_vectors; ///< a row of inputs for each coefficient
};

class SupportVector final : public StaticDamper {
  public:
    SupportVector(InputBox box, double stroke_m, SupportVectorParams params)
        : StaticDamper(std::move(box), stroke_m), params_(std::move(params)) {}

    double force_N(const DamperInput &input, const double *state, double *rates) const override;

  private:
    SupportVectorParams params_;
};

} // namespace quiesce

#endif
