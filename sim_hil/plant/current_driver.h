/// Current driver: limits the commanded current and rounds it to its output steps.
#ifndef QUIESCE_CURRENT_DRIVER_H
#define QUIESCE_CURRENT_DRIVER_H

namespace quiesce {

struct CurrentDriverParams {
    double max_current_A; ///< full scale, > 0
    int bits;             ///< resolution of 0 .. max_current_A, 1 .. 24
};

class CurrentDriver {
  public:
    explicit CurrentDriver(const CurrentDriverParams &params);

    /// The current that it drives for this command: 0 .. max_current_A, nearest step.
    double output_A(double command_A) const;

  private:
    double max_current_A_;
    double step_A_;
};

} // namespace quiesce

#endif
