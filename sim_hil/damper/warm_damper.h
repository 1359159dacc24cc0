/// A damper whose fluid warms up: by all that it takes out of the motion and by its coil, less what
/// it gives to its surroundings. One temperature for fluid, piston and housing.
///
///   heat_capacity T' = F v + coil_ohm I^2 - conductance (T - ambient)
///
/// F v is what the structure loses, so that nothing is lost or made: a spring or the gas in the
/// damper warms the fluid while it is loaded and cools it as much when it gives that back. The one
/// more state is T - start.
#ifndef QUIESCE_WARM_DAMPER_H
#define QUIESCE_WARM_DAMPER_H

#include <algorithm>
#include <memory>
#include <utility>

#include "damper.h"

namespace quiesce {

struct HeatParams {
    double heat_capacity_J_K; ///< > 0
    double conductance_W_K;   ///< to the surroundings, >= 0
    double ambient_C;
    double start_C;  ///< of the fluid, at time 0
    double coil_ohm; ///< >= 0; 0: the coil does not warm the fluid
};

class WarmDamper final : public Damper {
  public:
    WarmDamper(std::shared_ptr<const Damper> model, const HeatParams &heat)
        : model_(std::move(model)), heat_(heat) {}

    std::size_t state_count() const override { return model_->state_count() + 1; }
    bool uses_accel() const override { return model_->uses_accel(); }
    bool is_sampled() const override { return model_->is_sampled(); }

    double force_N(const DamperInput &input, const double *state, double *rates) const override {
        const DamperInput warm = warmed(input, state);
        const double force = model_->force_N(warm, state, rates);
        const double heat_W = force * input.velocity_m_s +
                              heat_.coil_ohm * input.current_A * input.current_A -
                              heat_.conductance_W_K * (warm.temperature_C - heat_.ambient_C);
        rates[model_->state_count()] = heat_W / heat_.heat_capacity_J_K;
        return force;
    }
    void after_step(const DamperInput &input, double *state, double dt_s) const override {
        model_->after_step(warmed(input, state), state, dt_s);
    }
    std::optional<double> fluid_C(const double *state) const override {
        return heat_.start_C + state[model_->state_count()];
    }

    double stiffest_N_s_m(double current_A) const override {
        return model_->stiffest_N_s_m(current_A);
    }
    double stiffest_N_m(double current_A) const override { return model_->stiffest_N_m(current_A); }
    double fastest_rate_1_s(double current_A) const override {
        return std::max(heat_.conductance_W_K / heat_.heat_capacity_J_K,
                        model_->fastest_rate_1_s(current_A));
    }
    double lowest_position_m() const override { return model_->lowest_position_m(); }

  private:
    DamperInput warmed(const DamperInput &input, const double *state) const {
        DamperInput out = input;
        out.temperature_C = *fluid_C(state);
        return out;
    }

    std::shared_ptr<const Damper> model_;
    HeatParams heat_;
};

} // namespace quiesce

#endif
