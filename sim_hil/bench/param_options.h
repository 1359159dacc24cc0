/// The controller's parameters from the command line.
#ifndef QUIESCE_PARAM_OPTIONS_H
#define QUIESCE_PARAM_OPTIONS_H

#include <string>
#include <vector>

#include "accelerometer.h"
#include "firmware.h"

namespace quiesce {

/// Sets the parameters that describe the accelerometer: scale and full scale.
void fit_to_sensor(quiesce_params_t &params, const AccelerometerParams &sensor);

/// Applies one NAME=VALUE. VALUE: an integer, or a label where the parameter has labels. Throws
/// InputError naming the parameter when it is unknown or the value is refused.
void set_param(quiesce_params_t &params, const std::string &assignment);

/// Throws InputError naming the first parameter that the controller would refuse, with its reason.
void require_accepted(const quiesce_params_t &params);

/// Label of the chosen law.
std::string law_label(const quiesce_params_t &params);

} // namespace quiesce

#endif
