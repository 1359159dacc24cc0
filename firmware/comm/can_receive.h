/// What other nodes tell the controller tick by tick: emergency stop, samples of sensors, measured
/// currents of dampers, the operator. Each is as old as its last accepted frame, and gone after its
/// timeout.
#ifndef CAN_RECEIVE_H
#define CAN_RECEIVE_H

#include "quiesce.h"
#include "quiesce_can_tables.h"

/// What the bus says in this tick.
typedef struct {
    bool enable;                              ///< OperatorCommand, not older than its timeout
    bool fault_reset;                         ///< its rising edge: true for one tick
    bool estop;                               ///< EmergencyStop, not older than its timeout
    quiesce_sample_t sensor[QUIESCE_SENSORS]; ///< counts are 0 unless it is fresh
    /// current_mA is 0 unless it is measured; has_failed: CurrentMeasured says open load, short,
    /// heat or supply.
    quiesce_driver_t driver[QUIESCE_DAMPERS];
} can_node_inputs_t;

/// Counters of what was refused, saturating at 2^32 - 1.
typedef struct {
    uint32_t rejected_crc;
    uint32_t rejected_alive;
    uint32_t rejected_shape;
    uint32_t unknown; ///< ids that are not for the controller: other nodes' traffic, no error
    uint32_t accepted;
} can_node_counters_t;

/// Of one message. Two ages: of what it said, and of its sender. A sender that hangs is still
/// heard; its alive counter is not forgotten, so that it never counts as a new one.
typedef struct {
    e2e_receiver_t e2e;
    uint32_t timeout_ticks;
    uint32_t age_ticks;    ///< since the last accepted frame
    uint32_t silent_ticks; ///< since the last frame with a right CRC
    bool is_present;
} can_receiver_t;

typedef struct {
    can_receiver_t from;
    uint32_t period_us; ///< between samples, as the board says; 0: one a tick
    int32_t counts;
    bool is_fresh; ///< since the last tick
} can_sensor_t;

typedef struct {
    can_receiver_t from;
    int32_t current_mA;
    bool has_failed;
} can_driver_t;

typedef struct {
    can_receiver_t stop;
    can_sensor_t sensor[QUIESCE_SENSORS];
    can_driver_t driver[QUIESCE_DAMPERS];
    can_receiver_t operator_command;
    e2e_receiver_t service;
    bool is_stop_seen; ///< since the last tick: a stop counts however long that tick is late
    bool enable;
    bool is_released;   ///< the last OperatorCommand had fault_reset = 0
    bool is_reset_edge; ///< since the last tick
    can_node_counters_t counters;
} can_receive_t;

/// Nothing received, no counts.
void can_receive_init(can_receive_t *self, uint32_t tick_rate_Hz);

/// Timeouts at another tick rate; what is received goes on.
void can_receive_use_rate(can_receive_t *self, uint32_t tick_rate_Hz);

/// Takes one frame. Returns true iff it is a ServiceRequest to act on.
bool can_receive_frame(can_receive_t *self, const can_frame_t *frame);

/// A tick begins, `ticks` after the last one (more than 1 where some were lost).
void can_receive_inputs(can_receive_t *self, uint32_t ticks, can_node_inputs_t *inputs);

#endif
