/// The sensing half of the controller, wired: all sensors, and of the accelerometer that is tracked
/// rms, estimator, displacement and, for laws that use it, the lock on the dominant component. It
/// writes what laws see.
#ifndef SIGNAL_CHAIN_H
#define SIGNAL_CHAIN_H

#include "displacement.h"
#include "dominant_lock.h"
#include "estimator.h"
#include "quiesce_params.h"
#include "rms.h"
#include "sensing.h"

typedef struct {
    sensing_t sensing;
    uint8_t tracked; ///< sensor
    rms_t rms;
    estimator_t estimator;
    displacement_t displacement;
    dominant_lock_state_t lock;
    uint32_t hold_ticks; ///< that laws go on with a frequency that is no longer valid
} signal_chain_t;

typedef struct {
    const quiesce_sample_t *samples; ///< QUIESCE_SENSORS of them
    uint32_t lost_ticks;             ///< just before this one
    const dominant_lock_t *lock;     ///< that the law wants, or NULL
} signal_chain_in_t;

/// Of the sensor that is tracked.
typedef struct {
    const condition_out_t *sample;
    int32_t rms_um_s2;
    int64_t velocity_um_s_q32;
    int32_t displacement_nm;
} signal_chain_out_t;

/// Starts from rest. Board and parameters have been checked; needs: as in sensing_init; lock: that
/// the law wants, or NULL.
void signal_chain_init(signal_chain_t *self, const quiesce_board_t *board,
                       const quiesce_params_t *params, uint64_t needs, const dominant_lock_t *lock);

/// One tick. What is known of the components is read from self->estimator; of *view, all but
/// is_output_on, may_learn and the dampers' currents is written.
void signal_chain_step(signal_chain_t *self, const signal_chain_in_t *in, view_t *view,
                       signal_chain_out_t *out);

#endif
