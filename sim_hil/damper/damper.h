/// A damper: the force with which it resists the motion of its two ends.
#ifndef QUIESCE_DAMPER_H
#define QUIESCE_DAMPER_H

#include <cstddef>
#include <optional>

namespace quiesce {

/// What a damper sees at one instant.
struct DamperInput {
    double velocity_m_s; ///< of the moving end; > 0 opens the gap (extends the damper)
    double position_m;   ///< of the moving end from its rest position, same direction
    double current_A;    ///< coil current, >= 0
    /// Of the moving end. Only for models that ask for it (uses_accel).
    double accel_m_s2 = 0.0;
    double temperature_C = 25.0; ///< of the fluid
};

/// Implementations are immutable: what a model remembers (hysteresis, a magnetic lag) is a state
/// vector that the plant owns and integrates together with the structure.
class Damper {
  public:
    virtual ~Damper() = default;

    /// Length of the model's state vector, which starts at zero.
    virtual std::size_t state_count() const { return 0; }

    /// Resisting force in N: > 0 opposes a positive velocity. state has state_count() elements;
    /// rates receives as many time derivatives. Both may be null where state_count() is 0.
    virtual double force_N(const DamperInput &input, const double *state, double *rates) const = 0;

    /// Upper bound of d force / d velocity (N s/m) at rest with this current: what the integration
    /// step must cope with.
    virtual double stiffest_N_s_m(double current_A) const = 0;

    /// The same for d force / d position (N/m).
    virtual double stiffest_N_m(double /*current_A*/) const { return 0.0; }

    /// Bound of |d rate / d state| (1/s) with this current, at the largest speed expected.
    virtual double fastest_rate_1_s(double /*current_A*/) const { return 0.0; }

    /// The force depends on the acceleration (on its sign): accel_estimate.h where there is none.
    virtual bool uses_accel() const { return false; }

    /// For models that sample: called once after each integration step with its length and what the
    /// damper sees at its end; may change the state, which is_sampled models leave constant in
    /// between.
    virtual void after_step(const DamperInput & /*input*/, double * /*state*/,
                            double /*dt_s*/) const {}

    /// The model runs at a sample time of its own (after_step).
    virtual bool is_sampled() const { return false; }

    /// Temperature of its fluid, of models that keep one (warm_damper.h); others are at what
    /// DamperInput says by default.
    virtual std::optional<double> fluid_C(const double * /*state*/) const { return {}; }

    /// Positions at or below this are outside the model (plates that touch).
    virtual double lowest_position_m() const = 0;
};

} // namespace quiesce

#endif
