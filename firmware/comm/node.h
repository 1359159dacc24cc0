/// What a controller with a CAN interface runs: the control step, its messages, its service
/// requests. Pure: plain data in and out, the same on a board and on Linux.
///
/// The target reads its sensors and inputs, calls node_step, writes the command to its driver,
/// does what node_task asks for, and sends the frames of node_frames. A target without a driver of
/// its own calls node_tick, which is all three.
#ifndef NODE_H
#define NODE_H

#include "can_node.h"
#include "image_service.h"
#include "safe_current.h"
#include "table_service.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Frames of a tick at the most.
#define NODE_MAX_FRAMES (CAN_NODE_MAX_FRAMES + 1u)

/// Words that it has the controller watch (quiesce_watch): its board, number 0. Those from here on
/// are the target's.
#define NODE_WATCHES 1u

/// Drivers that were held stay so for as long: who sends their measurements on the bus is trusted
/// again.
#define NODE_HELD_MS 100u

/// Where the operator's enable comes from.
typedef enum {
    NODE_ENABLE_BOARD = 0, ///< node_inputs_t.enable: a line, or always
    NODE_ENABLE_CAN = 1,   ///< OperatorCommand
    NODE_ENABLE_BOTH = 2,  ///< both of them
} node_enable_t;

/// Where what both board and bus can say comes from.
typedef struct {
    node_enable_t enable;
    uint32_t sensors_on_bus; ///< bit i: samples of sensor i are its frames; else node_inputs_t's
} node_sources_t;

/// What the board itself sees in a tick. Emergency stops, acknowledgements and failures of board
/// and bus add; a current that the board does not measure may come from the bus.
typedef struct {
    bool enable;
    bool estop;
    bool fault_reset;
    quiesce_sample_t sensor[QUIESCE_SENSORS];
    quiesce_driver_t driver[QUIESCE_DAMPERS]; ///< has_failed: it takes no command
    uint32_t ticks_elapsed;                   ///< 1, more where ticks were lost
    uint32_t overruns;                        ///< these and the following: see can_node_tick_t
    uint32_t lateness_us;
    uint32_t work_us;
    can_cycles_t cycles;
    can_unsent_t unsent;
    uint32_t bus_off_count;
    uint32_t rx_lost; ///< times that a line or an interface lost what had come
} node_inputs_t;

typedef struct {
    quiesce_t controller;
    can_node_t can;
    const quiesce_board_t *board; ///< the caller's, NULL: what parameters say
    quiesce_params_t params;      ///< in effect
    int32_t most_mA; ///< no APPLY raises max_current_mA above it; a board has ceilings of its own
    int32_t safe_mA[QUIESCE_DAMPERS]; ///< each damper's safe current with these parameters
    can_node_inputs_t bus;            ///< what the bus says in this tick
    quiesce_in_t in;                  ///< of the last step; counts and currents: the last ones had
    quiesce_out_t out;    ///< of the last step, or of the start: the command for the driver
    can_node_tick_t said; ///< what the frames of this tick say beyond out
    uint32_t restarts;    ///< with other parameters, since node_init
    uint32_t retunes;     ///< live parameters changed, likewise
    node_sources_t from;
    image_service_t images; ///< an update of the program
    bool drivers_are_held;  ///< the target's, between ticks: they are to be off, and stay so
    uint32_t held_ticks;    ///< left, that a hold lasts beyond its cause
    bool waits_for_release; ///< an enable that was given while they were held does not count
    bool is_asked;          ///< a request is, or was until the last tick
    table_service_t tables; ///< what is loaded; its keeper has the target's store
} node_t;

/// Starts from rest, without a store (node_use_store afterwards): commands are the safe currents.
/// board: what is wired to what, kept by the caller for as long as the node runs; NULL: one
/// accelerometer and one damper, as parameters say. Returns false iff a parameter or the board is
/// refused, or a signal is missing (quiesce_init_board); the controller then stays in its latched
/// fault, at the safe currents with the drivers off.
bool node_init(node_t *node, const quiesce_board_t *board, const quiesce_params_t *params,
               node_sources_t from);

/// Gives it the target's memory, without which whatever is to be stored is refused.
void node_use_store(node_t *node, keeper_store_t store, void *context);

/// Gives it the target's places for images (IMAGE_.. requests), without which there is no update
/// over the bus.
void node_use_images(node_t *node, const image_store_t *store);

/// What that memory or the configuration has of tables and of what was learnt, after node_init and
/// before the first tick. What is refused is not used; TABLE_INFO tells of it.
quiesce_table_verdict_t node_found(node_t *node, const table_found_t *found);

/// A table that is linked into the program takes the place of the one that ships, after node_init
/// and before node_found; one a road. file: all of it, its head first; the caller's for as long as
/// the node runs. What is refused is not used; TABLE_INFO tells of it.
quiesce_table_verdict_t node_ship(node_t *node, const uint32_t *file);

/// Another table while it runs, such as one from a configuration that has been read again: call it
/// once a tick, between ticks, with the same words, until it returns true. *verdict then says
/// whether it is in use.
bool node_offer(node_t *node, const table_found_t *found, quiesce_table_verdict_t *verdict);

/// The store says how what it has begun went.
void node_stored(node_t *node, bool is_stored);

/// A fault that a restart would forget; only refused parameters are mended by others.
bool node_has_latched_fault(const node_t *node);

/// Dampers in use: 0 .. node_dampers - 1.
uint32_t node_dampers(const node_t *node);

/// Takes a received frame, between ticks.
void node_receive(node_t *node, const can_frame_t *frame);

/// The first part of a tick: what the bus and the board say, and the control step. node->out then
/// has the command; write it to the driver before anything else.
void node_step(node_t *node, const node_inputs_t *inputs);

/// The second part: what a service request asks for. Returns the parameters with which the
/// controller is to be restarted now, else NULL; then write their safe currents
/// (safe_current_mA of node->board) to the drivers, switched off, call node_restart, write the
/// commands again. Parameters are refused while a fault is latched, which a
/// restart would forget, and above the max_current_mA of the start (most_mA); while the controller
/// is armed all but live ones are, and those take effect here (quiesce_params_use).
const quiesce_params_t *node_task(node_t *node);

/// The third part: the tick's frames. Returns their number.
uint32_t node_frames(node_t *node, can_frame_t frames[NODE_MAX_FRAMES]);

/// All three where there is no driver to write: the demand frame is the command.
uint32_t node_tick(node_t *node, const node_inputs_t *inputs, can_frame_t frames[NODE_MAX_FRAMES]);

/// Starts from rest with the same board and other parameters, which quiesce_params_check accepts:
/// commands are their safe currents, with the drivers off until the self-test has passed; counts in
/// node->restarts. As at any start, a latched fault is forgotten; tables and what was learnt are in
/// use again where law and tracker take them. The caller's tick has to run at params->tick_rate_Hz.
void node_restart(node_t *node, const quiesce_params_t *params);

/// Other values of live parameters, while it runs (quiesce_params_use); counts in node->retunes.
bool node_retune(node_t *node, const quiesce_params_t *params);

/// The last frames before leaving, one a damper: safe current, driver off. The drivers themselves
/// come first. Returns their number.
uint32_t node_farewell(node_t *node, can_frame_t frames[QUIESCE_DAMPERS]);

#ifdef __cplusplus
}
#endif

#endif
