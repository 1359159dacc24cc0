/// The equations of the damper models as graphs, traced from the models' own text (traced.h).
#ifndef QUIESCE_EQUATIONS_H
#define QUIESCE_EQUATIONS_H

#include <string>
#include <vector>

#include "traced.h"

namespace quiesce {

/// A function of named numbers; its arguments' names in order.
struct TracedFunction {
    std::string name;
    std::vector<std::string> arguments;
    Traced result;
};

/// Of a kernel, or of a spring or dashpot that a plant can have. Names: x, v, a, i (kernel.h), z0,
/// z1, .. the states, each parameter by its own, speed: the largest that is expected.
struct ModelEquations {
    std::string name;
    Traced force_N;
    std::vector<Traced> rates;
    Traced fastest_rate_1_s;
};

/// In the order of kernels.h; then the plain ones.
std::vector<ModelEquations> kernel_equations();
std::vector<ModelEquations> plain_equations();

/// effective(i) of field_law.h over exponent, saturation, reference.
TracedFunction field_law_equations();

/// The functions of elementary.h that nodes name, each after those that it uses.
std::vector<TracedFunction> elementary_equations();

} // namespace quiesce

#endif
