/// The plant in motion: structure, dampers, coils and excitation, integrated tick by tick.
///
///   eta'' + damping eta' + omega2 eta = at_force F_e(t) - sum_k stroke_k F_k(v_k, x_k, I_k)
///                                       - base_participation a_g(t)
///   I_k follows its driver's output with the coil's lag, and the coil's current with remanence
///
/// Classical Runge-Kutta with a fixed step that divides the tick; time is n / rate, never
/// accumulated. Error budget (docs/howto/describe-a-plant.md): the default longest step of 500 us
/// keeps every reduction of the frozen plant within 0.03 point of a run at 20 us.
#ifndef QUIESCE_PLANT_H
#define QUIESCE_PLANT_H

#include <cstdint>
#include <optional>
#include <vector>

#include "coil.h"
#include "current_driver.h"
#include "equations.h"
#include "excitation.h"
#include "plant_model.h"
#include "remanence.h"
#include "rk4.h"
#include "state_archive.h"

namespace quiesce {

/// True values at one instant, of the sensor and the first damper: what is kept of every step.
struct PlantTruth {
    double displacement_m;      ///< at the sensor, relative to the base
    double accel_m_s2;          ///< at the sensor, absolute: what an accelerometer reads
    double coil_A;              ///< what a current sensor reads; the damper's may lag behind it
    double damper_force_N;      ///< resisting force at the damper
    double phase_cycles;        ///< of the excitation, not wrapped
    double damper_velocity_m_s; ///< of its moving end, > 0 opens it
};

/// True values of a damper at one instant.
struct DamperTruth {
    double stroke_m;               ///< its end a less its end b, from rest; > 0: it is longer
    double velocity_m_s;           ///< of the stroke
    double force_N;                ///< resisting: > 0 resists a growing stroke
    double coil_A;                 ///< what a current sensor reads
    std::optional<double> fluid_C; ///< of a damper that keeps its temperature
};

/// What can be wrong between command and coil.
enum class ActuatorFault {
    none,
    coil_open,    ///< no current flows, at once
    driver_stuck, ///< the driver keeps its last output
};

class Plant {
  public:
    /// At rest at time 0, no current. excitation must outlive the plant. tick_rate_Hz: control
    /// ticks a second.
    Plant(const PlantModel &model, const Excitation &excitation, int tick_rate_Hz);

    /// Now, that is at tick() / tick_rate_Hz.
    const PlantTruth &truth() const { return truth_; }
    std::int64_t tick() const { return step_count_ / steps_; }
    double step_s() const { return step_s_; }

    /// The same instant: a place or a damper by its index in the model.
    PlaceTruth place(std::size_t index) const;
    DamperTruth damper(std::size_t index) const;

    /// What a damper's driver is told for the tick that advance integrates next.
    void command(std::size_t damper, double current_A, ActuatorFault fault);

    /// Integrates one tick. Returns the true values after each of its steps, the last of them now;
    /// valid until the next call. Throws InputError when the motion leaves a damper's range or the
    /// integration diverges.
    const std::vector<PlantTruth> &advance();

    /// What changes while it runs (state_archive.h).
    void visit_state(StateArchive &archive);

  private:
    struct Drive {
        double force_N;
        double base_accel_m_s2;
        DamperValues coil_A;
        DamperValues effective_A; ///< currents whose fields the dampers see
    };

    /// What is between a command and a damper.
    struct Actuator {
        Coil half_step_coil;
        Remanence remanence;
        double driver_A;
    };

    double time_s(double steps) const { return steps / step_rate_Hz_; }
    Drive drive_after(const Drive &before, const Excitation::Sample &excitation) const;
    void step();
    void observe();
    void check_motion() const;

    Equations equations_;
    const Excitation *excitation_;
    CurrentDriver driver_;
    std::int64_t steps_;  ///< in a tick
    double step_rate_Hz_; ///< an integer, so that step counts over it are exact times
    double step_s_;
    std::vector<Place> places_;
    std::vector<PlantDamper> dampers_;
    std::vector<Actuator> actuators_; ///< of each damper
    Rk4 rk4_;
    std::vector<double> y_;  ///< eta, eta', damper states
    std::vector<double> k1_; ///< their rates now
    DamperValues coil_A_{};
    DamperValues effective_A_{};
    DamperValues damper_force_N_{};
    std::size_t segment_ = 0; ///< of the excitation, now
    Excitation::Sample excitation_now_;
    std::int64_t step_count_ = 0;
    PlantTruth truth_{};
    std::vector<PlantTruth> substeps_;
};

} // namespace quiesce

#endif
