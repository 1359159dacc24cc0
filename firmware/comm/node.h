/// What a controller with a CAN interface runs: the control step, its messages, its service
/// requests. Pure: plain data in and out, the same on a board and on Linux.
///
/// The target reads its sensors and inputs, calls node_step, writes the command to its driver,
/// does what node_task asks for, and sends the frames of node_frames. A target without a driver of
/// its own calls node_tick, which is all three.
#ifndef NODE_H
#define NODE_H

#include "can_node.h"

/// Where the operator's enable comes from.
typedef enum {
    NODE_ENABLE_BOARD = 0, ///< node_inputs_t.enable: a line, or always
    NODE_ENABLE_CAN = 1,   ///< OperatorCommand
    NODE_ENABLE_BOTH = 2,  ///< both of them
} node_enable_t;

/// Where what both board and bus can say comes from.
typedef struct {
    node_enable_t enable;
    bool accel_is_on_bus; ///< samples are AccelSample frames; else node_inputs_t has them
} node_sources_t;

/// What the board itself sees in a tick. Emergency stops, acknowledgements and failures of board
/// and bus add; a current that the board does not measure may come from the bus.
typedef struct {
    bool enable;
    bool estop;
    bool fault_reset;
    bool driver_has_failed; ///< it takes no command; what it says on the bus adds
    bool accel_is_fresh;
    bool current_is_measured;
    int32_t accel_counts;
    int32_t current_meas_mA;
    uint32_t ticks_elapsed; ///< 1, more where ticks were lost
    uint32_t overruns;      ///< these and the following: see can_node_tick_t
    uint32_t lateness_us;
    uint32_t work_us;
    uint32_t tx_dropped;
    uint32_t bus_off_count;
} node_inputs_t;

/// Stores parameters for the next start. Returns false iff it could not; called from node_task.
typedef bool (*node_store_t)(void *context, const quiesce_params_t *params);

typedef struct {
    quiesce_t controller;
    can_node_t can;
    quiesce_params_t params; ///< in effect
    can_node_inputs_t bus;   ///< what the bus says in this tick
    quiesce_in_t in;         ///< of the last step; accel_counts, current_meas_mA: the last ones had
    quiesce_out_t out;       ///< of the last step, or of the start: the command for the driver
    can_node_tick_t said;    ///< what the frames of this tick say beyond out
    uint32_t restarts;       ///< with other parameters, since node_init
    node_sources_t from;
    node_store_t store; ///< NULL: there is none, SAVE is refused
    void *store_context;
    bool store_is_slow; ///< a store that returns true has only begun; it is called every tick until
                        ///< its owner says with can_node_answer how it went
} node_t;

/// Starts from rest, without a store (set store and store_context afterwards): the command is the
/// safe current. Returns false iff a parameter is refused; the controller then stays in its latched
/// fault, at the safe current with the driver off.
bool node_init(node_t *node, const quiesce_params_t *params, node_sources_t from);

/// Takes a received frame, between ticks.
void node_receive(node_t *node, const can_frame_t *frame);

/// The first part of a tick: what the bus and the board say, and the control step. node->out then
/// has the command; write it to the driver before anything else.
void node_step(node_t *node, const node_inputs_t *inputs);

/// The second part: what a service request asks for. Returns the parameters with which the
/// controller is to be restarted now, else NULL; then write their safe current
/// (quiesce_params_safe_current_mA) to the driver, whose output stage stays as it is, call
/// node_restart, write the command again. Parameters are refused while a fault is latched, which a
/// restart would forget.
const quiesce_params_t *node_task(node_t *node);

/// The third part: the tick's frames. Returns their number.
uint32_t node_frames(node_t *node, can_frame_t frames[CAN_NODE_MAX_FRAMES]);

/// All three where there is no driver to write: the demand frame is the command.
uint32_t node_tick(node_t *node, const node_inputs_t *inputs,
                   can_frame_t frames[CAN_NODE_MAX_FRAMES]);

/// Starts from rest with other parameters, which quiesce_params_check accepts: the command is their
/// safe current, with the driver on; counts in node->restarts. As at any start, a latched fault and
/// what was learnt are forgotten, the shipped rules and pulses are in use, and the caller's tick
/// has to run at params->tick_rate_Hz.
void node_restart(node_t *node, const quiesce_params_t *params);

/// The last frame before leaving: safe current, driver off. The driver itself comes first.
void node_farewell(node_t *node, can_frame_t *frame);

#endif
