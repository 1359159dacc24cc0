/// Coil and core: the current (and with it the field) follows the driver with a first-order lag
/// that may be slower one way than the other. Exact for a constant target.
#ifndef QUIESCE_COIL_H
#define QUIESCE_COIL_H

namespace quiesce {

struct CoilParams {
    double rise_s;          ///< time constant towards a larger current, >= 0 (0: no lag)
    double fall_s;          ///< towards a smaller one, >= 0
    double remanence = 0.0; ///< width of its play, part of the driver's full scale
};

class Coil {
  public:
    /// step_s: the time that one call of step covers, > 0.
    Coil(const CoilParams &params, double step_s);

    /// The current step_s later, from current_A with the driver at target_A.
    double step(double current_A, double target_A) const {
        return target_A + (current_A - target_A) * left(current_A, target_A);
    }
    /// Part of their difference that is left then.
    double left(double current_A, double target_A) const {
        return target_A > current_A ? rise_left_ : fall_left_;
    }

  private:
    double rise_left_; ///< part of the difference that is left after a step
    double fall_left_;
};

} // namespace quiesce

#endif
