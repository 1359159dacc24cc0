/// A place of a structure: where a sensor or an end of a damper is.
#ifndef QUIESCE_PLACE_H
#define QUIESCE_PLACE_H

#include <Eigen/Core>

#include <string>

namespace quiesce {

struct Place {
    std::string name;
    Eigen::VectorXd shape; ///< mass-normalised, of each mode, kg^-1/2
    double base;           ///< how it moves with the base: 1, all of it
};

} // namespace quiesce

#endif
