/// What an ADXL355 that does not start says to a person.
#ifndef ADXL355_ERROR_H
#define ADXL355_ERROR_H

#include "linux_error.h"
#include "part_bus.h"

/// One line about the problem. Returns true iff there is none. range_g, rate_Hz: asked for.
bool adxl355_explain(const part_problem_t *problem, uint32_t range_g, uint32_t rate_Hz,
                     linux_error_t *error);

#endif
