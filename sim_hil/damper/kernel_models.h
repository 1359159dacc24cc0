/// The kernels as data: what there is, and how to make a damper of each.
#ifndef QUIESCE_KERNEL_MODELS_H
#define QUIESCE_KERNEL_MODELS_H

#include <memory>
#include <vector>

#include "kernel_damper.h"

namespace quiesce {

struct KernelModel {
    const char *name;
    const char *title;
    const char *source;
    const ParameterInfo *parameters;
    std::size_t parameter_count;
    /// The first so many are known of a damper (its geometry) and not found by a fit:
    /// Kernel::kTold, in kernels that have such parameters.
    std::size_t told_count;
    int state_count;
    bool uses_accel;
    double (*fastest_rate_1_s)(const double *p, double speed_m_s);
    bool (*is_passive)(const double *p);
    std::shared_ptr<const Damper> (*make)(const CurrentLaw *laws, double stroke_m, double speed_m_s,
                                          const FieldLaw<double> &field, const FluidLaw &fluid);
};

/// In the order of kernels.h.
const std::vector<KernelModel> &kernel_models();

} // namespace quiesce

#endif
