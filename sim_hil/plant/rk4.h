/// One step of the classical fourth-order Runge-Kutta method.
#ifndef QUIESCE_RK4_H
#define QUIESCE_RK4_H

#include <cstddef>
#include <vector>

namespace quiesce {

/// Workspace for states of one length.
class Rk4 {
  public:
    explicit Rk4(std::size_t count) : k2_(count), k3_(count), k4_(count), trial_(count) {}

    /// Advances y by dt_s. k1: its rates now. rates(stage, y, out) writes the rates at the start of
    /// the step plus dt_s/2 (stage 1) or dt_s (stage 2).
    template <typename Rates>
    void step(std::vector<double> &y, const std::vector<double> &k1, double dt_s, Rates &&rates) {
        offset(y, k1, 0.5 * dt_s);
        rates(1, trial_, k2_);
        offset(y, k2_, 0.5 * dt_s);
        rates(1, trial_, k3_);
        offset(y, k3_, dt_s);
        rates(2, trial_, k4_);
        const double sixth = dt_s / 6.0;
        for (std::size_t i = 0; i < y.size(); ++i) {
            y[i] += sixth * (k1[i] + 2.0 * (k2_[i] + k3_[i]) + k4_[i]);
        }
    }

  private:
    void offset(const std::vector<double> &y, const std::vector<double> &rates, double dt_s) {
        for (std::size_t i = 0; i < y.size(); ++i) {
            trial_[i] = y[i] + dt_s * rates[i];
        }
    }

    std::vector<double> k2_;
    std::vector<double> k3_;
    std::vector<double> k4_;
    std::vector<double> trial_;
};

} // namespace quiesce

#endif
