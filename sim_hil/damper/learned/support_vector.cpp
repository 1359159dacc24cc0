#include "support_vector.h"

#include "support_vector_core.h"

namespace quiesce {

double SupportVector::force_N(const DamperInput &input, const double * /*state*/,
                              double * /*rates*/) const {
    const Inputs u = box().scaled(input);
    const quiesce_support_vector core{static_cast<int>(box().count()),
                                      static_cast<int>(params_.coefficients.size()),
                                      params_.force_scale_N,
                                      params_.gamma,
                                      params_.intercept,
                                      params_.coefficients.data(),
                                      params_.support_vectors.data()};
    return quiesce_support_vector_N(&core, u.data());
}

} // namespace quiesce
