/// A plant under a recorded acceleration of its base and currents that are given tick by tick, and
/// how what it does changes with those currents: a discrete adjoint of the simulation, exact but
/// for the differences of RatesPullback.
///
/// The motion is that of Plant, by the same equations, coils and Runge-Kutta steps. Only the state
/// at each tick is kept: the way back integrates every tick once more, with all stages of its
/// steps.
#ifndef QUIESCE_OPEN_LOOP_H
#define QUIESCE_OPEN_LOOP_H

#include <cstddef>
#include <vector>

#include "coil.h"
#include "current_driver.h"
#include "equations.h"
#include "excitation.h"
#include "plant_model.h"
#include "rates_pullback.h"
#include "remanence.h"
#include "rk4.h"

namespace quiesce {

/// Of one motion: [tick][place] or [tick][damper], true values at each tick. As weights, the same
/// of slopes.
template <typename Number>
struct MotionColumns {
    Number *disp_m;     ///< of a place, relative to the base
    Number *accel_m_s2; ///< absolute
    Number *stroke_m;   ///< of a damper
    Number *force_N;    ///< resisting
    Number *coil_A;
};

class OpenLoop {
  public:
    /// Throws InputError for a plant with a damper that samples. step_factor >= 1: times the
    /// model's longest step; how far that is stable is for the caller to see.
    OpenLoop(const PlantModel &model, const Excitation &excitation, int tick_rate_Hz,
             std::size_t ticks, double step_factor);

    const PlantModel &model() const { return model_; }
    std::size_t ticks() const { return ticks_; }
    double step_s() const { return step_s_; }

    /// From rest without current. command_A [tick][damper]: what each driver puts out for the tick
    /// that begins with it, 0 .. max_current_A; with is_rounded in the driver's steps. Throws
    /// InputError where a damper closes or the integration diverges.
    void run(const double *command_A, bool is_rounded, const MotionColumns<double> &out);

    /// Of the last run: out [tick][damper] = slopes of the sum of weights times what was recorded.
    /// The rounding of the driver is not seen.
    void pull(const MotionColumns<const double> &weights, double *out);

  private:
    struct Currents {
        DamperValues coil_A;
        DamperValues effective_A; ///< currents whose fields the dampers see
    };
    struct State {
        std::vector<double> y; ///< eta, eta', damper states
        Currents currents;
    };
    /// What the way back needs of a step.
    struct StepTape {
        std::vector<double> y[4]; ///< states of its stages
        Currents currents[3];     ///< at its start, middle and end
    };

    double base_accel(std::size_t step, int half) const {
        return base_m_s2_[2 * step + static_cast<std::size_t>(half)];
    }
    Currents after_half_step(const Currents &before, const double *driver_A) const;
    Currents before_half_step(const Currents &weights, const Currents &before,
                              const Currents &after, const double *driver_A,
                              double *of_driver) const;
    void advance(std::size_t step, const double *driver_A, State &state, StepTape *tape);
    DamperValues rates_now(std::size_t step, const State &state);
    void record(std::size_t tick, const State &state, const MotionColumns<double> &out);
    void check(std::size_t tick, const State &state) const;
    void retreat(std::size_t tick, double *of_driver);
    void pull_step(const StepTape &tape, const double *driver_A, double *of_driver);
    void pull_record(std::size_t tick, const MotionColumns<const double> &weights);
    void pull_rates(const std::vector<double> &y, const Currents &at, Currents &of_currents);

    PlantModel model_;
    Equations equations_;
    CurrentDriver driver_;
    RatesPullback pullback_;
    std::size_t ticks_;
    std::size_t steps_; ///< in a tick
    double step_rate_Hz_;
    double step_s_;
    std::vector<Coil> half_step_coils_;
    std::vector<Remanence> remanences_;
    std::vector<double> base_m_s2_; ///< at every half step
    Rk4 rk4_;
    std::vector<double> k1_;

    std::vector<double> driver_A_; ///< [tick][damper] of the last run
    std::vector<State> at_ticks_;
    Reached reached_;
    std::vector<StepTape> tape_; ///< of one tick

    // The way back: slopes by the state and the currents, weights of the rates and forces.
    std::vector<double> of_state_;
    Currents of_currents_{};
    DamperValues of_force_{};
    std::vector<double> of_rates_;
    std::vector<double> of_stage_;
};

} // namespace quiesce

#endif
