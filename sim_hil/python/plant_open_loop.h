/// A plant under a recorded acceleration of its base and currents given tick by tick, with the
/// slopes of what it does: for searches of a current's waveform.
#ifndef QUIESCE_PLANT_OPEN_LOOP_H
#define QUIESCE_PLANT_OPEN_LOOP_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Not for several threads at once.
typedef struct quiesce_open_loop quiesce_open_loop;

/// accel_m_s2 [points] of the base at rising time_s [points], as a scenario's record: times
/// divided by time_scale, accelerations times gain, straight lines between, nothing after its end.
typedef struct {
    int tick_rate_Hz; ///< 1 .. 1000000
    size_t ticks;     ///< 2 or more
    size_t points;    ///< 2 or more
    const double *time_s;
    const double *accel_m_s2;
    double time_scale; ///< > 0
    double gain;
    double step_factor; ///< >= 1, times the plant file's longest step
} quiesce_shaking;

/// [tick][place] or [tick][damper], in the order of the plant file.
typedef struct {
    double *disp_m;     ///< of a place, relative to the base
    double *accel_m_s2; ///< absolute
    double *stroke_m;   ///< of a damper
    double *force_N;    ///< resisting
    double *coil_A;
} quiesce_motion;

/// NULL where the plant file is wrong, or its motion has no slopes.
quiesce_open_loop *quiesce_open_loop_start(const char *plant_file, const quiesce_shaking *shaking,
                                           char *error, size_t error_size);
void quiesce_open_loop_free(quiesce_open_loop *loop);

double quiesce_open_loop_max_current_A(const quiesce_open_loop *loop);
/// NULL beyond the last one; they live as long as the loop.
const char *quiesce_open_loop_place(const quiesce_open_loop *loop, size_t index);
const char *quiesce_open_loop_damper(const quiesce_open_loop *loop, size_t index);

/// From rest; command_A [tick][damper] is what a driver puts out for the tick that begins with it,
/// 0 .. max_current_A, in the driver's steps where is_rounded is not 0. Fails where a damper closes
/// to the end of its range or the integration diverges.
int quiesce_open_loop_run(quiesce_open_loop *loop, const double *command_A, int is_rounded,
                          const quiesce_motion *motion, char *error, size_t error_size);

/// Of the last run: out [tick][damper] gets the slopes, by command_A, of the sum of weights times
/// what was recorded. Fails where there was no run.
int quiesce_open_loop_pull(quiesce_open_loop *loop, const quiesce_motion *weights, double *out,
                           char *error, size_t error_size);

#ifdef __cplusplus
}
#endif

#endif
