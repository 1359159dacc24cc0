#include "kernel_models.h"

#include <type_traits>

#include "kernels.h"

namespace quiesce {

namespace {

template <class Kernel, class = void>
constexpr std::size_t kToldOf = 0;
template <class Kernel>
constexpr std::size_t kToldOf<Kernel, std::void_t<decltype(Kernel::kTold)>> = Kernel::kTold;

template <class Kernel>
KernelModel describe() {
    return {
        Kernel::kName,
        Kernel::kTitle,
        Kernel::kSource,
        Kernel::kParameters.data(),
        Kernel::kParameters.size(),
        kToldOf<Kernel>,
        Kernel::kStates,
        Kernel::kUsesAccel,
        [](const double *p, double speed_m_s) { return Kernel::fastest_rate_1_s(p, speed_m_s); },
        Kernel::is_passive,
        [](const CurrentLaw *laws, double stroke_m, double speed_m_s, const FieldLaw<double> &field,
           const FluidLaw &fluid) -> std::shared_ptr<const Damper> {
            return std::make_shared<KernelDamper<Kernel>>(laws, stroke_m, speed_m_s, field, fluid);
        }};
}

} // namespace

const std::vector<KernelModel> &kernel_models() {
#define QUIESCE_DESCRIBE(Kernel) describe<Kernel>(),
    static const std::vector<KernelModel> models{QUIESCE_KERNELS(QUIESCE_DESCRIBE)};
#undef QUIESCE_DESCRIBE
    return models;
}

} // namespace quiesce
