/// What a controller with a CAN interface runs: the application, its messages, its service
/// requests. The same on a board and on Linux; only the HAL behind it differs.
#ifndef NODE_H
#define NODE_H

#include "app.h"
#include "can_node.h"

/// Where the operator's enable comes from.
typedef enum {
    NODE_ENABLE_BOARD = 0, ///< node_inputs_t.enable: a line, or always
    NODE_ENABLE_CAN = 1,   ///< OperatorCommand
    NODE_ENABLE_BOTH = 2,  ///< both of them
} node_enable_t;

/// What the board itself sees in a tick. Emergency stops and acknowledgements of board and bus add.
typedef struct {
    bool enable;
    bool estop;
    bool fault_reset;
    bool driver_has_failed; ///< it takes no command; what it says on the bus adds
    uint32_t ticks_elapsed; ///< 1, more where ticks were lost
    uint32_t overruns;      ///< these and the following: see can_node_tick_t
    uint32_t lateness_us;
    uint32_t work_us;
    uint32_t tx_dropped;
    uint32_t bus_off_count;
} node_inputs_t;

/// Stores parameters for the next start. Returns false iff it could not; called from the tick.
typedef bool (*node_store_t)(void *context, const quiesce_params_t *params);

typedef struct {
    app_t app;
    can_node_t can;
    quiesce_params_t params; ///< in effect
    can_node_inputs_t bus;   ///< what the bus says in this tick
    uint32_t restarts;       ///< with other parameters, since node_init
    node_enable_t enable;
    node_store_t store; ///< NULL: there is none, SAVE is refused
    void *store_context;
    bool store_is_slow; ///< a store that returns true has only begun; it is called every tick until
                        ///< its owner says with can_node_answer how it went
    hal_accel_t *accel;
    hal_current_t *current;
} node_t;

/// Starts from rest, without a store (set store and store_context afterwards). Returns false iff a
/// parameter is refused (the controller then stays in its latched fault and commands the safe
/// current).
bool node_init(node_t *node, const quiesce_params_t *params, node_enable_t enable,
               hal_accel_t *accel, hal_current_t *current);

/// Restarts the controller with other parameters: safe current first, then from rest; counts in
/// node->restarts. As at any start, a latched fault and what was learnt are forgotten, the shipped
/// rules and pulses are in use, and the caller's tick has to run at params->tick_rate_Hz. Returns
/// false, and changes nothing, iff a parameter is refused; *error (may be NULL) then says which.
bool node_use_params(node_t *node, const quiesce_params_t *params, quiesce_param_error_t *error);

/// Takes a received frame, between ticks.
void node_receive(node_t *node, const can_frame_t *frame);

/// Newest sample of the sensor node since the last tick, for an accelerometer backend that reads it
/// from the bus. Returns false iff there is none.
bool node_accel_sample(const node_t *node, int32_t *counts);

/// Likewise the driver's measured current.
bool node_current_measured(const node_t *node, int32_t *current_mA);

/// One control tick: what the bus and the board say, the control step, then a task that a service
/// request asked for. APPLY goes through node_use_params (look at node->restarts after the tick);
/// it is refused while a fault is latched, which a restart would forget. Returns the number of
/// frames to send now.
uint32_t node_tick(node_t *node, const node_inputs_t *inputs,
                   can_frame_t frames[CAN_NODE_MAX_FRAMES]);

/// Safe current to the driver and, as a frame, to the bus: the last thing before leaving.
void node_leave(node_t *node, can_frame_t *frame);

#endif
