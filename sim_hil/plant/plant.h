/// The plant in motion: structure, damper, coil and excitation, integrated tick by tick.
///
///   eta'' + damping eta' + omega2 eta = at_force F_e(t) - at_damper F_d(v_d, x_d, I)
///   I follows the driver's output with the coil's lag
///
/// Classical Runge-Kutta with a fixed step that divides the tick; time is n * dt, never
/// accumulated. Error budget (docs/plant.md, measured against dt = 20 us): the default longest step
/// of 250 us keeps every reduction of the frozen plant within 0.01 point.
#ifndef QUIESCE_PLANT_H
#define QUIESCE_PLANT_H

#include <cstdint>
#include <vector>

#include "coil.h"
#include "current_driver.h"
#include "excitation.h"
#include "plant_model.h"
#include "rk4.h"

namespace quiesce {

/// True values at one instant.
struct PlantTruth {
    double displacement_m; ///< at the sensor
    double accel_m_s2;     ///< at the sensor
    double coil_A;
    double damper_force_N; ///< resisting force at the damper
    double phase_cycles;   ///< of the excitation, not wrapped
};

/// What can be wrong between command and coil.
enum class ActuatorFault {
    none,
    coil_open,    ///< no current flows, at once
    driver_stuck, ///< the driver keeps its last output
};

class Plant {
  public:
    /// At rest at time 0, no current. excitation must outlive the plant. tick_s: control period.
    Plant(const PlantModel &model, const Excitation &excitation, double tick_s);

    /// Now, that is at tick() * tick_s.
    const PlantTruth &truth() const { return truth_; }
    std::int64_t tick() const { return tick_; }
    int steps_per_tick() const { return steps_; }

    /// What the driver is told for the tick that advance integrates next.
    void command(double current_A, ActuatorFault fault);

    /// Integrates one tick. Returns the true values after each of its steps, the last of them now;
    /// valid until the next call. Throws InputError when the motion leaves the damper's range or
    /// the integration diverges.
    const std::vector<PlantTruth> &advance();

  private:
    struct Drive {
        double force_N;
        double current_A;
    };

    void rates(const Drive &drive, const std::vector<double> &y, std::vector<double> &out);
    void step();
    void observe();
    void check_motion() const;

    Structure structure_;
    std::shared_ptr<const Damper> damper_;
    const Excitation *excitation_;
    CurrentDriver driver_;
    int steps_;
    double tick_s_;
    double step_s_;
    Coil half_step_coil_;
    Rk4 rk4_;
    std::vector<double> y_;  ///< eta, eta', damper states
    std::vector<double> k1_; ///< their rates now
    double driver_A_ = 0.0;
    double coil_A_ = 0.0;
    double damper_force_N_ = 0.0;
    Excitation::Sample excitation_now_;
    std::int64_t tick_ = 0;
    std::int64_t step_count_ = 0;
    PlantTruth truth_{};
    std::vector<PlantTruth> substeps_;
};

} // namespace quiesce

#endif
