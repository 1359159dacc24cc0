#include "free_node.h"

#include "shipped.h"

#include <stddef.h>

// The linker's: code and constants.
extern const uint32_t program_begin[];
extern const uint32_t program_end[];

// A fault of the processor is an emergency stop up to the first tick that has latched it.
static bool keep_fault(free_node_t *self) {
    const bool is_fault = self->node.out.telemetry.state == QUIESCE_STATE_FAULT;
    const bool is_acknowledged = self->is_after_fault && self->is_latched && !is_fault;
    if (is_acknowledged) {
        self->is_after_fault = false;
    }
    self->is_latched = self->is_after_fault && is_fault;
    return is_acknowledged;
}

// After a fault: the drivers are told to be off before anything else is done. What the fault has
// cut off in the middle of a line ends here.
static void say_farewell(free_node_t *self) {
    can_frame_t frames[QUIESCE_DAMPERS];
    const uint32_t count = node_farewell(&self->node, frames);
    frame_queue_break(&self->queue);
    for (uint32_t i = 0; i < count; i++) {
        frame_queue_put(&self->queue, &frames[i]);
    }
}

static void start_controller(free_node_t *self, const free_node_start_t *start) {
    node_t *const node = &self->node;
    quiesce_params_t shipped;
    quiesce_params_t params;
    quiesce_params_default(&shipped);
    kept_open(&self->kept, start->memory, start->wiring, &shipped);
    if (!kept_read_params(&self->kept, &params) ||
        !node_init(node, start->wiring, &params, start->sources)) {
        (void)node_init(node, start->wiring, &shipped, start->sources);
    }
    if (node->board == NULL) {
        node->most_mA = shipped.max_current_mA;
    }
    node_use_store(node, kept_store, &self->kept);
}

// What was learnt comes last: it is of the law's table.
static void find_tables(free_node_t *self) {
    static const keeper_record_t records[] = {KEEPER_LAW_TABLE, KEEPER_TRACKER_TABLE,
                                              KEEPER_LEARNT};
    for (uint32_t i = 0; shipped_tables[i] != NULL; i++) {
        (void)node_ship(&self->node, shipped_tables[i]);
    }
    for (uint32_t i = 0; i < sizeof records / sizeof records[0]; i++) {
        uint32_t *const words = quiesce_tables_room(&self->node.tables.tables);
        const uint32_t count = kept_read(&self->kept, records[i], words, QUIESCE_TABLE_WORDS);
        const table_found_t found = {.record = records[i],
                                     .source = TABLE_FROM_STORE,
                                     .words = words,
                                     .count = count,
                                     .writes = kept_writes(&self->kept, records[i])};
        keeper_found_as(&self->node.tables.keeper, records[i], self->kept.state);
        (void)node_found(&self->node, &found);
    }
}

void free_node_start(free_node_t *self, const free_node_start_t *start) {
    slcan_decoder_init(&self->decoder);
    start_controller(self, start);
    self->is_after_fault = start->is_after_fault;
    if (self->is_after_fault) {
        say_farewell(self);
    }
    find_tables(self);
    quiesce_watch(&self->node.controller, NODE_WATCHES, program_begin,
                  ((uintptr_t)program_end - (uintptr_t)program_begin) / sizeof(uint32_t));
}

void free_node_begin(free_node_t *self, uint32_t ticks) {
    const bool is_fault = self->node.out.telemetry.state == QUIESCE_STATE_FAULT;
    self->inputs.ticks_elapsed = ticks;
    self->inputs.overruns += ticks - 1u;
    self->inputs.unsent = self->queue.unsent;
    self->inputs.estop = self->estop_line || (self->is_after_fault && !is_fault);
}

bool free_node_end(free_node_t *self, const can_frame_t *frames, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        frame_queue_put(&self->queue, &frames[i]);
    }
    return keep_fault(self);
}

bool free_node_is_idle(const free_node_t *self) {
    return self->queue.count == 0u && !self->kept.is_writing;
}

void free_node_receive(free_node_t *self, hal_uart_t *uart) {
    can_frame_t frame;
    uint8_t byte;
    for (uint32_t i = 0; i < SLCAN_MAX_BYTES && hal_uart_read(uart, &byte); i++) {
        if (slcan_decode(&self->decoder, byte, &frame)) {
            node_receive(&self->node, &frame);
        }
    }
}

void free_node_store(free_node_t *self) {
    const hal_nvm_progress_t progress = kept_work(&self->kept);
    if (progress == HAL_NVM_DONE || progress == HAL_NVM_FAILED) {
        node_stored(&self->node, progress == HAL_NVM_DONE);
    }
}
