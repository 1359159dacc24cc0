/// Simulation in time of a plant whose drive and current command are given tick by tick.
#ifndef QUIESCE_PLANT_SIMULATE_H
#define QUIESCE_PLANT_SIMULATE_H

#include "plant_library.h"

#ifdef __cplusplus
extern "C" {
#endif

/// All arrays have `ticks` elements. Drive = amplitude_V sin(2 pi phase_cycles), with straight
/// lines between the ticks in both; the shaker's roll-off sees the slope of the phase. A command
/// holds for the tick that begins with it and passes through the driver (limits, rounding).
typedef struct {
    int tick_rate_Hz; ///< 1 .. 1000000
    size_t ticks;
    const double *amplitude_V;
    const double *phase_cycles;
    const double *command_A;
} quiesce_drive;

/// True values at each tick, each array with as many elements as the drive. disp_m and coil_A may
/// be NULL.
typedef struct {
    double *accel_m_s2;
    double *disp_m;
    double *coil_A;
} quiesce_response;

/// From rest without current at tick 0. Steps of at most the plant file's max_step_us. Fails where
/// the damper closes to the end of its range or the integration diverges.
int quiesce_plant_simulate(const quiesce_plant *plant, const quiesce_drive *drive,
                           const quiesce_response *response, char *error, size_t error_size);

#ifdef __cplusplus
}
#endif

#endif
