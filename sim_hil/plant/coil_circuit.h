/// Electric circuit of a damper's coil behind a PWM bridge: what a current loop works against.
///
///     L(i) di/dt = v - R(T) i,   L(i) = L0 / (1 + (i / i_s)^2),   R(T) = R20 (1 + a (T - 20))
///     tau dT/dt = Rth i^2 R(T) - (T - T_ambient)
///
/// v is the supply less its droop while the bridge is on, and minus a diode's drop (one switch: the
/// current cannot reverse) or zero (full bridge) while it is off. The PWM is centred: a period is
/// off, on, off, so that a sample at its begin is near its mean. Each piece is solved exactly with
/// L and R of its begin, in steps of at most 5 us.
#ifndef QUIESCE_COIL_CIRCUIT_H
#define QUIESCE_COIL_CIRCUIT_H

#include <cstdint>

#include "noise.h"

namespace quiesce {

struct CoilCircuitParams {
    double resistance_ohm = 5.0; ///< at 20 degC, > 0
    double inductance_H = 0.1;   ///< without current, > 0
    double saturation_A = 0.0;   ///< i_s, at which half of it is left; 0: it does not saturate
    double thermal_K_W = 5.0;    ///< Rth
    double thermal_s = 600.0;    ///< tau, > 0
    double ambient_degC = 20.0;
    double supply_V = 12.0;  ///< without load, > 0
    double supply_ohm = 0.1; ///< its droop
    bool is_full_bridge = false;
    double diode_V = 0.7;
    int pwm_periods = 2;             ///< in a step of the loop
    int pwm_counts = 4200;           ///< of the timer: the duty's resolution
    double sense_noise_A = 0.005;    ///< standard deviation
    double sense_full_scale_A = 4.0; ///< -full scale .. full scale
    int sense_bits = 12;
    double supply_sense_V = 40.0; ///< full scale, from 0, of as many bits
};

class CoilCircuit {
  public:
    /// step_s: of the current loop, > 0.
    CoilCircuit(const CoilCircuitParams &params, double step_s, std::uint64_t seed);

    /// A step of the loop: duty -1 .. 1 of the supply; one switch takes negative ones as 0.
    void run(double duty);

    double current_A() const { return current_A_; }
    double temperature_degC() const { return temperature_degC_; }
    double resistance_ohm() const;
    /// What the current comes to at full duty.
    double most_current_A() const;

    /// As a converter gives them: noise, rounding, limits.
    std::int32_t sensed_mA();
    std::int32_t sensed_supply_mV() const;

    void set_temperature_degC(double temperature_degC) { temperature_degC_ = temperature_degC; }

  private:
    void piece(double voltage_V, double series_ohm, double time_s);

    CoilCircuitParams params_;
    double step_s_;
    double current_A_ = 0.0;
    double temperature_degC_;
    double load_A_ = 0.0; ///< mean current out of the supply in the last step
    Noise noise_;
};

} // namespace quiesce

#endif
