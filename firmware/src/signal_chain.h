/// The sensing half of the controller, wired: condition, rms, spectrum, tracker, motion.
#ifndef SIGNAL_CHAIN_H
#define SIGNAL_CHAIN_H

#include "condition.h"
#include "motion.h"
#include "quiesce_params.h"
#include "rms.h"
#include "spectrum.h"
#include "tracker.h"

typedef struct {
    condition_t condition;
    rms_t rms;
    spectrum_t spectrum;
    tracker_t tracker;
    motion_t motion;
} signal_chain_t;

typedef struct {
    int32_t accel_counts; ///< ignored unless is_fresh
    bool is_fresh;
    bool has_gap; ///< ticks were lost before this one
} signal_chain_in_t;

typedef struct {
    condition_out_t sample;
    int32_t rms_um_s2;
    int64_t velocity_um_s_q32;
} signal_chain_out_t;

/// Starts from rest. The parameters have been checked.
void signal_chain_init(signal_chain_t *self, const quiesce_params_t *params);

/// One tick. What the tracker knows is read from self->tracker.
void signal_chain_step(signal_chain_t *self, const signal_chain_in_t *in, signal_chain_out_t *out);

#endif
