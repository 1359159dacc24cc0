#include "coil.h"

#include <cmath>

namespace quiesce {

namespace {

double part_left(double time_constant_s, double step_s) {
    return time_constant_s > 0.0 ? std::exp(-step_s / time_constant_s) : 0.0;
}

} // namespace

Coil::Coil(const CoilParams &params, double step_s)
    : rise_left_(part_left(params.rise_s, step_s)), fall_left_(part_left(params.fall_s, step_s)) {}

} // namespace quiesce
