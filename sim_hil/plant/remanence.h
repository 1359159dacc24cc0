/// Remanence: the core keeps some of the field that it had. Rate-independent play between the coil
/// current and the effective current, the one whose field the damper sees:
///
///   effective = max(coil, min(effective before, coil + width))
///
/// Rising, the effective current is the coil's; falling, it stays where it was and then follows
/// width above the coil's.
#ifndef QUIESCE_REMANENCE_H
#define QUIESCE_REMANENCE_H

#include <algorithm>

namespace quiesce {

class Remanence {
  public:
    /// width_A >= 0; 0: no remanence, the effective current is the coil's.
    explicit Remanence(double width_A) : width_A_(width_A) {}

    /// The effective current at coil_A, from effective_A before; exact where the coil current has
    /// moved one way in between.
    double step(double effective_A, double coil_A) const {
        return std::max(coil_A, std::min(effective_A, coil_A + width_A_));
    }

  private:
    double width_A_;
};

} // namespace quiesce

#endif
