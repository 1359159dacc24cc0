#include "support_vector.h"

#include <cmath>

namespace quiesce {

double SupportVector::force_N(const DamperInput &input, const double * /*state*/,
                              double * /*rates*/) const {
    const Inputs u = box().scaled(input);
    const std::size_t count = box().count();
    const double *vector = params_.support_vectors.data();
    double sum = params_.intercept;
    for (const double coefficient : params_.coefficients) {
        double distance2 = 0.0;
        for (std::size_t k = 0; k < count; ++k) {
            distance2 += (u[k] - vector[k]) * (u[k] - vector[k]);
        }
        sum += coefficient * std::exp(-params_.gamma * distance2);
        vector += count;
    }
    return params_.force_scale_N * sum;
}

} // namespace quiesce
