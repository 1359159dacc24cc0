/// What an image that runs free has in common on all boards: a controller with its CAN interface
/// (node.h), what it keeps over a power-up (kept.h), the queue to its serial line, and what it does
/// after a fault of the processor: it starts anew, in a latched fault, until the operator
/// acknowledges.
///
/// The board's main calls, in this order: free_node_start; for each tick free_node_begin, the
/// node's step and what belongs to it (node.h), free_node_end; in between free_node_store.
#ifndef FREE_NODE_H
#define FREE_NODE_H

#include "frame_queue.h"
#include "hal/uart.h"
#include "kept.h"
#include "node.h"
#include "slcan.h"

typedef struct {
    node_t node;
    kept_t kept;
    frame_queue_t queue;
    slcan_decoder_t decoder; ///< of the serial line
    node_inputs_t inputs;
    bool estop_line;     ///< of the board, set by its main; a fault of the processor adds
    bool is_after_fault; ///< of the processor, and nobody has acknowledged
    bool is_latched;     ///< it is the controller's fault now
} free_node_t;

/// What the board's main knows.
typedef struct {
    const quiesce_board_t *wiring; ///< NULL: what parameters say
    node_sources_t sources;
    hal_nvm_memory_t *memory; ///< of the records
    bool is_after_fault;      ///< of the processor; the drivers are then told to be off first
} free_node_start_t;

/// With the parameters and tables that were saved, where they are accepted; no saved ones raise the
/// ceiling of the current that ships. Puts a farewell into the queue after a fault.
void free_node_start(free_node_t *self, const free_node_start_t *start);

/// inputs for the step of this tick. ticks: that have elapsed, 1 or more.
void free_node_begin(free_node_t *self, uint32_t ticks);

/// Puts the tick's frames into the queue. Returns true iff the operator has acknowledged a fault of
/// the processor: its record is to be forgotten.
bool free_node_end(free_node_t *self, const can_frame_t *frames, uint32_t count);

/// Whether nothing waits to be sent or saved.
bool free_node_is_idle(const free_node_t *self);

/// Frames that have come on the serial line, of at most as many bytes as a frame has: a host that
/// floods the line cannot hold up the tick.
void free_node_receive(free_node_t *self, hal_uart_t *uart);

/// A slice of what is being saved, in idle time.
void free_node_store(free_node_t *self);

#endif
