/// Files of tables over ISO-TP, in both directions (TableData, TableFlow): what comes goes into the
/// room for tables that arrive, what goes is taken from words that are in use. Nothing that arrives
/// is used here.
#ifndef TABLE_LINK_H
#define TABLE_LINK_H

#include "can_frame.h"
#include "isotp.h"
#include "table_file.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Zeros: idle.
typedef struct {
    isotp_t isotp;
    uint32_t head[TABLE_FILE_HEAD_WORDS]; ///< of the file that comes or goes
    uint32_t word;                        ///< that the bytes so far begin
    uint32_t words;                       ///< that have come, head included
    const uint32_t *sent;                 ///< the table that goes
} table_link_t;

/// Takes a frame of TableData.
void table_link_take(table_link_t *self, const can_frame_t *frame, quiesce_tables_t *tables);

/// A whole file has come, and its head is right.
bool table_link_has_file(const table_link_t *self);

/// Begins to send the file of a table, which stays where it is; returns its bytes.
uint32_t table_link_send(table_link_t *self, const uint32_t *words, uint32_t board);

/// Whether that table is on its way to the host.
static inline bool table_link_is_sending(const table_link_t *self, const uint32_t *words) {
    return self->sent == words &&
           (self->isotp.state == ISOTP_AWAITING || self->isotp.state == ISOTP_SENDING);
}

/// What is under way, or has come, is of no use any more.
void table_link_drop(table_link_t *self);

/// Time passes, ms; then the frame of TableFlow that is due. Sums what comes as it does. Returns
/// false iff none is.
bool table_link_tick(table_link_t *self, uint32_t passed_ms, quiesce_tables_t *tables,
                     can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
