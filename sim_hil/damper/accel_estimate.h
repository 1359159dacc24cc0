/// Gives a model that asks for the acceleration an estimate of it: in a plant the acceleration
/// follows from the force, so it cannot be an input. One more state follows the velocity with a
/// lag; a = (v - followed) / lag.
#ifndef QUIESCE_ACCEL_ESTIMATE_H
#define QUIESCE_ACCEL_ESTIMATE_H

#include <algorithm>
#include <memory>
#include <utility>

#include "damper.h"

namespace quiesce {

class AccelEstimate final : public Damper {
  public:
    explicit AccelEstimate(std::shared_ptr<const Damper> model) : model_(std::move(model)) {}

    std::size_t state_count() const override { return model_->state_count() + 1; }

    double force_N(const DamperInput &input, const double *state, double *rates) const override {
        const std::size_t last = model_->state_count();
        DamperInput with_accel = input;
        with_accel.accel_m_s2 = (input.velocity_m_s - state[last]) / kLag_s;
        rates[last] = with_accel.accel_m_s2;
        return model_->force_N(with_accel, state, rates);
    }
    double stiffest_N_s_m(double current_A) const override {
        return model_->stiffest_N_s_m(current_A);
    }
    double stiffest_N_m(double current_A) const override { return model_->stiffest_N_m(current_A); }
    double fastest_rate_1_s(double current_A) const override {
        return std::max(1.0 / kLag_s, model_->fastest_rate_1_s(current_A));
    }
    void after_step(const DamperInput &input, double *state, double dt_s) const override {
        DamperInput with_accel = input;
        with_accel.accel_m_s2 = (input.velocity_m_s - state[model_->state_count()]) / kLag_s;
        model_->after_step(with_accel, state, dt_s);
    }
    bool is_sampled() const override { return model_->is_sampled(); }
    std::optional<double> fluid_C(const double *state) const override {
        return model_->fluid_C(state);
    }
    double lowest_position_m() const override { return model_->lowest_position_m(); }

  private:
    static constexpr double kLag_s = 2e-3;
    std::shared_ptr<const Damper> model_;
};

} // namespace quiesce

#endif
