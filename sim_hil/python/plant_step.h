/// Simulation in time, tick by tick: for control laws that are written in Python.
#ifndef QUIESCE_PLANT_STEP_H
#define QUIESCE_PLANT_STEP_H

#include "plant_library.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct quiesce_run quiesce_run;

/// True values at one tick.
typedef struct {
    double disp_m;       ///< at the sensor, relative to the base
    double velocity_m_s; ///< likewise
    double accel_m_s2;   ///< at the sensor, absolute
    double stroke_m;     ///< of the damper
    double stroke_velocity_m_s;
    double damper_force_N; ///< resisting
    double coil_A;
    double fluid_C; ///< NaN where the damper keeps no temperature
} quiesce_now;

/// What acts in a tick.
typedef struct {
    double force_N; ///< of the shaker
    double base_accel_m_s2;
    double command_A;
} quiesce_acting;

/// From rest without current or excitation. plant must outlive it. NULL where the rate is outside
/// 1 .. 1000000 ticks a second.
quiesce_run *quiesce_run_start(const quiesce_plant *plant, int tick_rate_Hz, quiesce_now *now,
                               char *error, size_t error_size);
void quiesce_run_free(quiesce_run *run);

/// One tick on. The shaker's force and the acceleration of the base go in straight lines from what
/// they were to these, at the tick's end; the command holds for the tick and passes through the
/// driver (limits, rounding). Fails where the damper closes or the integration diverges.
int quiesce_run_advance(quiesce_run *run, const quiesce_acting *acting, quiesce_now *now,
                        char *error, size_t error_size);

#ifdef __cplusplus
}
#endif

#endif
