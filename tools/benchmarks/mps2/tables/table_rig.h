/// The node of a controller with one accelerometer and one damper, armed in a steady vibration:
/// what goes in and out of its ticks.
#ifndef TABLE_RIG_H
#define TABLE_RIG_H

#include "node.h"

enum { RIG_PERIOD_ticks = 100, RIG_SETTLED_ticks = 2500, RIG_MOST_HEARD = 3 };

/// What a run is to do, in the mailbox.
typedef struct {
    uint32_t part;
    uint32_t ticks;
    uint32_t tables;
    uint32_t params[QUIESCE_PARAM_COUNT];
    uint32_t words[]; ///< of all tables, one after the other
} rig_order_t;

typedef struct {
    node_t node;
    node_inputs_t board;
    can_frame_t frames[NODE_MAX_FRAMES];
    uint32_t sent;
    can_frame_t heard[RIG_MOST_HEARD];
    uint32_t heard_count;
    uint32_t number; ///< of the tick
    uint32_t noise;
} rig_t;

/// Words of a table.
uint32_t rig_count(const uint32_t *words);

/// Its CRC.
uint32_t rig_crc(const uint32_t *words);

/// The road that it takes.
uint8_t rig_road(const uint32_t *words);

/// Table `number` of an order.
const uint32_t *rig_table(const rig_order_t *order, uint32_t number);

/// With the parameters of the order and its first `used` tables in use. Returns false iff the
/// parameters are refused; prints how many tables are.
bool rig_start(rig_t *rig, const rig_order_t *order, uint32_t used);

/// Received with the next tick.
void rig_hear(rig_t *rig, const can_frame_t *frame);

/// The next tick's sample and enable are there.
void rig_prepare(rig_t *rig);

/// A tick with what was heard for it.
void rig_tick(rig_t *rig);

/// After a tick.
void rig_pass(rig_t *rig);

/// The frame of this id among those that were sent; NULL: none.
const can_frame_t *rig_sent(const rig_t *rig, uint32_t id);

#endif
