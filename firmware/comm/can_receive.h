/// What other nodes tell the controller tick by tick: emergency stop, samples of sensors, measured
/// currents of dampers, the operator. A frame counts if its counter and its time fit (freshness.h),
/// and what it says is gone after its timeout. What stops needs neither: a good EmergencyStop, an
/// OperatorCommand without enable and a CurrentMeasured with a failure act at once.
#ifndef CAN_RECEIVE_H
#define CAN_RECEIVE_H

#include "freshness.h"
#include "quiesce.h"
#include "quiesce_can_tables.h"

#ifdef __cplusplus
extern "C" {
#endif

/// What the bus says in this tick.
typedef struct {
    bool enable;                              ///< OperatorCommand, not older than its timeout
    bool fault_reset;                         ///< its rising edge: true for one tick
    bool estop;                               ///< EmergencyStop, not older than its timeout
    quiesce_sample_t sensor[QUIESCE_SENSORS]; ///< counts are 0 unless it is fresh
    /// current_mA is 0 unless it is measured, and is_old between two frames; has_failed:
    /// CurrentMeasured says open load, short, heat or supply.
    quiesce_driver_t driver[QUIESCE_DAMPERS];
} can_node_inputs_t;

/// Counters of what was refused, saturating at 2^32 - 1.
typedef struct {
    uint32_t rejected_crc;
    uint32_t rejected_alive; ///< the counter or the time of arrival does not fit
    uint32_t rejected_shape;
    uint32_t unknown;  ///< ids that are not for the controller: other nodes' traffic, no error
    uint32_t accepted; ///< neither refused nor of a sender on trial
} can_node_counters_t;

/// EmergencyStop: its counter is not judged, one good frame is enough.
typedef struct {
    uint32_t timeout_ticks;
    uint32_t age_ticks; ///< since the last good frame
    bool is_present;
    bool is_seen; ///< since the last tick: a stop counts however long that tick is late
} can_stop_t;

/// A sample that comes with another in one tick waits for the next tick, which may have none: while
/// the sensor's clock and the controller's pass each other, samples come in none of some ticks and
/// in two of others. Once CAN_SENSOR_CALM_MS have each brought one, what waits is passed over.
#define CAN_SENSOR_CALM_MS 250u

typedef struct {
    freshness_t from;
    uint32_t period_us; ///< between samples, as the board says; 0: as usual on the bus
    quiesce_sample_t
        waiting[2];      ///< the older one first; one at most where samples are rarer than ticks
    uint8_t count;       ///< 0 .. 2 that wait
    uint8_t come;        ///< since the last tick, saturating at 2
    uint16_t calm_ticks; ///< in a row that brought one each
} can_sensor_t;

typedef struct {
    freshness_t from;
    int32_t current_mA;
    bool has_failed;
    bool is_new;          ///< current_mA, since the last tick
    bool failure_is_seen; ///< since the last tick, whatever the frame's counter and time
} can_driver_t;

/// Where fault_reset is on its way: released in two frames, pressed in two, and it acts with the
/// one after them, which shows that the last was nobody else's.
typedef enum {
    CAN_PRESS_NONE = 0, ///< not known, or held
    CAN_PRESS_RELEASED_ONCE = 1,
    CAN_PRESS_RELEASED = 2,
    CAN_PRESS_ONCE = 3,
    CAN_PRESS_TWICE = 4,
} can_press_t;

/// What starts something has to be said by two frames in a row: nobody runs or acknowledges because
/// of a single one.
typedef struct {
    freshness_t from;
    bool enable;
    bool was_enabled;   ///< the last frame of the row had enable = 1
    bool was_let_go;    ///< a frame of the row had enable = 0
    can_press_t press;  ///< of fault_reset, in the frames of the row
    bool is_reset_edge; ///< since the last tick
} can_operator_t;

typedef struct {
    can_stop_t stop;
    can_sensor_t sensor[QUIESCE_SENSORS];
    can_driver_t driver[QUIESCE_DAMPERS];
    can_operator_t operator_command;
    int32_t tick_us;
    uint32_t calm_ticks; ///< in CAN_SENSOR_CALM_MS
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

#ifdef __cplusplus
}
#endif

#endif
