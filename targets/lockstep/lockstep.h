/// Lock-step server: one stimulus in, one control tick, one reply out.
///
/// The bench drives every target through this: in its own process, through RAM shared with an
/// emulator (mailbox.h), or as SLCAN frames over a UART (lockstep_can.h). Behind it is the same
/// control step that a board runs; the stimulus is all that it sees.
#ifndef LOCKSTEP_H
#define LOCKSTEP_H

#include "quiesce.h"

#ifdef __cplusplus
extern "C" {
#endif

/// lockstep_stimulus_t.flags
#define LOCKSTEP_FRESH 1u        ///< accel_counts is a new sample
#define LOCKSTEP_ENABLE 2u       ///< operator enables the output
#define LOCKSTEP_ESTOP 4u        ///< emergency stop pressed
#define LOCKSTEP_FAULT_RESET 8u  ///< operator acknowledges a latched fault
#define LOCKSTEP_HAS_CURRENT 16u ///< current_meas_mA is a measurement
#define LOCKSTEP_REPORT 32u      ///< the law's report is wanted; without it its words are 0

/// What a target sees in one tick. Words only: the same layout on every target.
typedef struct {
    int32_t accel_counts;
    uint32_t flags;
    int32_t current_meas_mA;
} lockstep_stimulus_t;

/// What it answers.
typedef struct {
    int32_t current_cmd_mA;
    uint32_t is_driver_enabled;
    quiesce_telemetry_t telemetry;
    int32_t report[QUIESCE_REPORT_WORDS];
} lockstep_reply_t;

typedef struct {
    quiesce_t controller;
    quiesce_in_t in;   ///< of the last tick
    quiesce_out_t out; ///< of the last tick
} lockstep_t;

/// (Re)starts the controller from rest. Returns false iff a parameter is refused; the controller is
/// then in its latched fault state and keeps commanding the safe current.
bool lockstep_start(lockstep_t *server, const quiesce_params_t *params);

/// One control tick.
void lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in, lockstep_reply_t *out);

#ifdef __cplusplus
}
#endif

#endif
