#include "quadrature.h"

namespace quiesce {

void update_quadrature(const QuadratureParams &params, double position_m, double velocity_m_s,
                       double dt_s, double *means) {
    quiesce_quadrature_update(&params, position_m, velocity_m_s, dt_s, means);
}

QuadratureFeatures quadrature_features(const QuadratureParams &params, double position_m,
                                       double velocity_m_s, const double *means) {
    QuadratureFeatures out{};
    quiesce_quadrature_write(&params, position_m, velocity_m_s, means, out.data());
    return out;
}

} // namespace quiesce
