#include "current_driver.h"

#include <algorithm>
#include <cmath>

namespace quiesce {

CurrentDriver::CurrentDriver(const CurrentDriverParams &params)
    : max_current_A_(params.max_current_A),
      step_A_(params.max_current_A / static_cast<double>((1 << params.bits) - 1)) {}

double CurrentDriver::output_A(double command_A) const {
    const double limited_A = std::clamp(command_A, 0.0, max_current_A_);
    return step_A_ * std::floor(limited_A / step_A_ + 0.5);
}

} // namespace quiesce
