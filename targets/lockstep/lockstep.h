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
#define LOCKSTEP_ENABLE 2u              ///< operator enables the output
#define LOCKSTEP_ESTOP 4u               ///< emergency stop pressed
#define LOCKSTEP_FAULT_RESET 8u         ///< operator acknowledges a latched fault
#define LOCKSTEP_LOST 16u               ///< the tick is lost: the rest of it is not looked at
#define LOCKSTEP_REPORT 32u             ///< the law's report is wanted; without it its words are 0
#define LOCKSTEP_PICTURE 64u            ///< the picture is wanted; without it it is left as it is
#define LOCKSTEP_FRESH (1u << 8)        ///< counts[0] is a new sample; << i: counts[i]
#define LOCKSTEP_HAS_CURRENT (1u << 16) ///< current_meas_mA[0] is a measurement; << i: of damper i

/// What a target sees in one tick: of all sensors and dampers that there can be, so that one layout
/// serves every build. Words only.
typedef struct {
    uint32_t flags;
    int32_t counts[QUIESCE_MAX_SENSORS];
    int32_t current_meas_mA[QUIESCE_MAX_DAMPERS];
} lockstep_stimulus_t;

/// What it answers. What the target's build has no damper for is left as it is.
typedef struct {
    int32_t current_cmd_mA[QUIESCE_MAX_DAMPERS];
    uint32_t drivers_enabled; ///< a bit for each damper
    quiesce_telemetry_t telemetry;
    int32_t report[QUIESCE_REPORT_WORDS];
    quiesce_picture_t picture;
} lockstep_reply_t;

/// Tables that a start may bring, in the order of their use.
enum { LOCKSTEP_LAW_TABLE, LOCKSTEP_TRACKER_TABLE, LOCKSTEP_TABLES };

/// Words of the caller, which must not change before the next start.
typedef struct {
    const uint32_t *words;
    uint32_t count; ///< 0: there is none; more than QUIESCE_TABLE_WORDS are refused unread
} lockstep_table_t;

/// The table that a start refused. Words only.
typedef struct {
    uint32_t verdict; ///< quiesce_table_verdict_t; OK: it refused none
    uint32_t table;   ///< LOCKSTEP_LAW_TABLE or LOCKSTEP_TRACKER_TABLE
} lockstep_refusal_t;

typedef struct {
    quiesce_t controller;
    lockstep_refusal_t refused; ///< by the last start
    quiesce_in_t in;            ///< of the last tick
    quiesce_out_t out;          ///< of the last tick
} lockstep_t;

/// (Re)starts the controller from rest. board: NULL where the parameters say what is wired. tables:
/// LOCKSTEP_TABLES of them; NULL: none, the law has what ships. Returns false iff a parameter, the
/// board or a table is refused, or the law lacks a signal; the controller is then in its latched
/// fault state and keeps commanding the safe current.
bool lockstep_start(lockstep_t *server, const quiesce_board_t *board,
                    const quiesce_params_t *params, const lockstep_table_t *tables);

/// One control tick; with LOCKSTEP_LOST the controller does not run, and the reply is the last
/// one's.
void lockstep_exchange(lockstep_t *server, const lockstep_stimulus_t *in, lockstep_reply_t *out);

/// What a stimulus has for a controller: a sample of each sensor, a measurement of each driver.
void lockstep_take(const lockstep_stimulus_t *stimulus, quiesce_sample_t sensor[QUIESCE_SENSORS],
                   quiesce_driver_t driver[QUIESCE_DAMPERS]);

/// Writes the reply of a controller whose last output is out. flags: of the stimulus.
void lockstep_tell(const quiesce_t *controller, const quiesce_out_t *out, uint32_t flags,
                   lockstep_reply_t *reply);

#ifdef __cplusplus
}
#endif

#endif
