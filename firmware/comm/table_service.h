/// Requests about tables (operations TABLE_.., LEARNT_.. of ServiceRequest): check, use, go back,
/// store for the next start, tell, send. What has come over TableData is used whole and checked, or
/// not at all, between two ticks; the table before it is kept.
#ifndef TABLE_SERVICE_H
#define TABLE_SERVICE_H

#include "can_service.h"
#include "keeper.h"
#include "learnt.h"
#include "table_link.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Roads: what requests are about. The first two are quiesce_owner_t.
enum { ROAD_LAW, ROAD_TRACKER, ROAD_LEARNT, ROADS };

/// Where what is in use came from (TABLE_INFO).
typedef enum {
    TABLE_FROM_NOWHERE = 0, ///< there is none
    TABLE_SHIPS = 1,
    TABLE_FROM_CAN = 2,
    TABLE_FROM_STORE = 3,  ///< an earlier run's
    TABLE_FROM_CONFIG = 4, ///< a file of the target's configuration
} table_source_t;

/// TABLE_INFO's request value.
enum {
    TABLE_INFO_CRC = 0,
    TABLE_INFO_MAGIC = 1,
    TABLE_INFO_STORED_CRC = 2,
    TABLE_INFO_SOURCE = 3,
    TABLE_INFO_BOARD = 4,
    TABLE_INFO_WRITES = 5,
    TABLE_INFO_REFUSAL = 6,
    TABLE_INFO_RECORD = 7, ///< keeper_state_t
    TABLE_INFOS
};

/// What every tick looks at stands first: it is reached in one instruction.
typedef struct {
    bool is_working; ///< on a request, since an earlier tick
    uint32_t board;  ///< CRC-32 of its words, 0: there is none
    struct {
        table_source_t source; ///< of the one that is loaded
        quiesce_table_verdict_t refusal;
    } of[ROADS];
    table_link_t link;
    keeper_t keeper;
    learnt_store_t learnt;
    quiesce_tables_t tables;
} table_service_t;

/// Nothing is loaded or kept. board: NULL where parameters say what is wired.
void table_service_init(table_service_t *self, const quiesce_board_t *board);

/// A whole file of a table that is linked into the program: from now on it is the one that ships.
quiesce_table_verdict_t table_service_ship(table_service_t *self, quiesce_t *controller,
                                           const uint32_t *file);

/// What an earlier run or the target's configuration has: used where the controller takes it. A
/// good table that law and tracker do not take waits until they do (after other parameters), unless
/// one of its road is there already.
typedef struct {
    keeper_record_t record; ///< but KEEPER_PARAMS
    table_source_t source;
    const uint32_t *words; ///< copied
    uint32_t count;
    uint32_t writes; ///< of the record so far; TABLE_FROM_STORE only
} table_found_t;

quiesce_table_verdict_t table_service_found(table_service_t *self, quiesce_t *controller,
                                            const table_found_t *found);

/// A table while it runs, which is summed over ticks as one from the bus is: call it once a tick,
/// with the same words, until it returns true and *verdict says how it went. A transfer that is
/// under way is given up.
bool table_service_offer(table_service_t *self, quiesce_t *controller, const table_found_t *found,
                         quiesce_table_verdict_t *verdict);

/// Works on a request, once a tick. Returns true once *result and *value are its reply.
bool table_service_work(table_service_t *self, quiesce_t *controller,
                        const can_service_request_t *request, can_node_result_t *result,
                        int32_t *value);

/// The target says how the record under way went (keeper.h).
void table_service_stored(table_service_t *self, bool is_stored);

/// There is no request any more.
static inline void table_service_rest(table_service_t *self) {
    self->is_working = false;
    keeper_give_up(&self->keeper);
}

/// Around a restart of the controller: what was in use, has waited or was learnt before is used
/// where it fits.
void table_service_before_restart(table_service_t *self, const quiesce_t *controller);
void table_service_after_restart(table_service_t *self, quiesce_t *controller);

/// A tick of passed_ms in which there is something to do. What is to be sent does not begin before
/// the reply that tells of it has left (is_answered).
typedef struct {
    const quiesce_t *controller;
    uint32_t passed_ms;
    bool is_answered;
} table_tick_t;

/// Once a tick: time passes. Returns false iff there is nothing to do in it; else
/// table_service_tick.
static inline bool table_service_pass(table_service_t *self, uint32_t passed_ms) {
    return learnt_pass(&self->learnt, passed_ms) || !isotp_is_idle(&self->link.isotp);
}

/// Returns false iff there is no frame of TableFlow to send.
bool table_service_tick(table_service_t *self, const table_tick_t *tick, can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
