/// The simulated plant as a C library, which Python's quiesce.plant calls.
///
/// A handle holds one plant file with one damper. Calls with it change nothing in it, so that
/// threads may share it.
/// Functions that can fail return 0 on success, else 1 with one line in error (cut to error_size).
#ifndef QUIESCE_PLANT_LIBRARY_H
#define QUIESCE_PLANT_LIBRARY_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct quiesce_plant quiesce_plant;

typedef struct {
    double max_current_A;
    double drive_V;     ///< amplitude in the plant file
    double max_step_s;  ///< longest integration step in the plant file
    double safe_step_s; ///< the longest that the plant's fastest motion allows
    double rise_s;      ///< of the coil
    double fall_s;
    int driver_bits;
    int mode_count;
} quiesce_plant_facts;

typedef struct {
    double freq_Hz;
    double damping_ratio; ///< from the diagonal of the damping matrix
    double at_force;      ///< mass-normalised shape, kg^-1/2
    double at_damper;
    double at_sensor;
} quiesce_plant_mode;

/// NULL where the file cannot be read or is wrong, or has several dampers.
quiesce_plant *quiesce_plant_load(const char *file, char *error, size_t error_size);
void quiesce_plant_free(quiesce_plant *plant);

void quiesce_plant_get_facts(const quiesce_plant *plant, quiesce_plant_facts *facts);
/// 0 <= mode < mode_count.
void quiesce_plant_get_mode(const quiesce_plant *plant, int mode, quiesce_plant_mode *out);
/// Amplitude of what the shaker gives for 1 V: N, or m/s2 where it moves the base.
double quiesce_plant_shaker_per_V(const quiesce_plant *plant, double freq_Hz);

/// Periodic motion under the shaker's drive_V g(f) sin(theta), theta = 2 pi freq_Hz t, and a driver
/// output that is constant in each of `intervals` equal parts of half a period of the excitation
/// (covers_period 0; repeated in the second half) or of the whole period (covers_period 1).
/// Continuous in time: no control ticks, no rounding of the current.
typedef struct {
    double freq_Hz;
    double drive_V;
    int intervals; ///< 1 .. 100000
    int covers_period;
} quiesce_orbit_case;

/// x ~ disp_fundamental_m cos(theta + disp_phase_rad), and the acceleration alike.
typedef struct {
    double amp_m; ///< half peak-to-peak displacement at the sensor
    double rms_disp_m;
    double accel_rms_m_s2;
    double mean_current_A; ///< of the coil
    double disp_fundamental_m;
    double disp_phase_rad;
    double accel_fundamental_m_s2;
    double accel_phase_rad;
    double residual; ///< change of the state over the period, relative to its largest value
    int periods;     ///< simulated to find the orbit
} quiesce_orbit_figures;

/// Any pointer but figures may be NULL. grid: quiesce_orbit_grid of the case.
typedef struct {
    quiesce_orbit_figures figures;
    double *start; ///< [state count] at theta = 0: a first guess (first NaN: none), then the answer
    double *disp_m;      ///< [grid] at theta = 2 pi k / grid
    double *accel_m_s2;  ///< [grid]
    double *coil_A;      ///< [grid]
    double *disp_per_A;  ///< [grid][intervals] d disp_m / d command
    double *accel_per_A; ///< [grid][intervals]; both of these or neither
} quiesce_orbit;

/// Points in a period, at least 400 and no further apart than max_step_s: a multiple of the
/// number of intervals in a period. 0 where the case is not allowed.
size_t quiesce_orbit_grid(const quiesce_plant *plant, const quiesce_orbit_case *orbit_case);
size_t quiesce_orbit_state_count(const quiesce_plant *plant);

/// Finds the orbit for command_A [intervals], each 0 .. max_current_A.
int quiesce_orbit_solve(const quiesce_plant *plant, const quiesce_orbit_case *orbit_case,
                        const double *command_A, quiesce_orbit *orbit, char *error,
                        size_t error_size);

#ifdef __cplusplus
}
#endif

#endif
