#include "table_service.h"

#include <stddef.h>

#include "quiesce_can.h"

#define CRC_WORD 1u ///< of every table
#define COUNT_WORD 2u
#define SUMMED_A_TICK 16u ///< words, some 1,000 instructions

static const keeper_record_t record_of[ROADS] = {KEEPER_LAW_TABLE, KEEPER_TRACKER_TABLE,
                                                 KEEPER_LEARNT};

void table_service_init(table_service_t *self, const quiesce_board_t *board) {
    quiesce_tables_init(&self->tables);
    table_link_drop(&self->link);
    keeper_init(&self->keeper);
    learnt_init(&self->learnt);
    self->board = table_file_board(board);
    self->is_working = false;
    for (uint32_t i = 0; i < ROADS; i++) {
        self->of[i].source = TABLE_FROM_NOWHERE;
        self->of[i].refusal = QUIESCE_TABLE_OK;
    }
}

static bool is_learnt(const uint32_t *words, uint32_t count) {
    return count > 0u && words[0] == TABLE_FILE_LEARNT;
}

// Of what has arrived; the law's where nobody knows it.
static uint32_t road_of(const uint32_t *words, uint32_t count) {
    quiesce_owner_t owner = QUIESCE_OF_LAW;
    if (is_learnt(words, count)) {
        return ROAD_LEARNT;
    }
    if (count > 0u) {
        (void)quiesce_table_kind(words[0], &owner);
    }
    return (uint32_t)owner;
}

// ---- from an earlier run, or a file -------------------------------------------------------------

static quiesce_table_verdict_t find_learnt(table_service_t *self, quiesce_t *controller,
                                           const table_found_t *found) {
    if (!learnt_is_whole(found->words, found->count)) {
        return QUIESCE_TABLE_CRC;
    }
    for (uint32_t i = 0; i < found->count; i++) {
        self->learnt.kept.words[i] = found->words[i];
    }
    return learnt_put(found->words, found->count, controller) ? QUIESCE_TABLE_OK
                                                              : QUIESCE_TABLE_FIT;
}

static uint32_t road_found(const table_found_t *found) {
    return (uint32_t)found->record - (uint32_t)KEEPER_LAW_TABLE;
}

// One of another law waits for it: parameters that were applied, but not saved, come back later.
static quiesce_table_verdict_t find_table(table_service_t *self, quiesce_t *controller,
                                          const table_found_t *found) {
    if (!quiesce_tables_write(&self->tables, 0, found->words, found->count)) {
        return QUIESCE_TABLE_SIZE;
    }
    const quiesce_table_verdict_t verdict = quiesce_tables_check(&self->tables, controller);
    if (verdict == QUIESCE_TABLE_OK) {
        return quiesce_tables_commit(&self->tables, controller);
    }
    if (quiesce_tables_keep(&self->tables)) {
        self->of[road_found(found)].source = found->source;
    }
    return verdict;
}

static quiesce_table_verdict_t settle(table_service_t *self, const table_found_t *found,
                                      quiesce_table_verdict_t verdict) {
    const uint32_t road = road_found(found);
    self->of[road].refusal = verdict;
    if (verdict == QUIESCE_TABLE_OK) {
        self->of[road].source = found->source;
    }
    return verdict;
}

quiesce_table_verdict_t table_service_found(table_service_t *self, quiesce_t *controller,
                                            const table_found_t *found) {
    const uint32_t road = road_found(found);
    const bool is_stored = found->source == TABLE_FROM_STORE;
    if (is_stored) {
        keeper_found(&self->keeper, found->record, found->count > 1u ? found->words[CRC_WORD] : 0u,
                     found->writes);
    }
    if (found->count == 0u) {
        return QUIESCE_TABLE_OK;
    }
    return settle(self, found,
                  road == ROAD_LEARNT ? find_learnt(self, controller, found)
                                      : find_table(self, controller, found));
}

// What has arrived is this very table.
static bool is_arrival(const table_service_t *self, const table_found_t *found) {
    uint32_t count;
    const uint32_t *words = quiesce_tables_arrival(&self->tables, &count);
    return count == found->count && words[CRC_WORD] == found->words[CRC_WORD];
}

bool table_service_offer(table_service_t *self, quiesce_t *controller, const table_found_t *found,
                         quiesce_table_verdict_t *verdict) {
    if (!is_arrival(self, found)) {
        table_link_drop(&self->link);
        if (!quiesce_tables_write(&self->tables, 0, found->words, found->count)) {
            *verdict = settle(self, found, QUIESCE_TABLE_SIZE);
            return true;
        }
    }
    if (!quiesce_tables_sum(&self->tables, SUMMED_A_TICK)) {
        return false;
    }
    *verdict = settle(self, found, quiesce_tables_commit(&self->tables, controller));
    return true;
}

// ---- linked into the program --------------------------------------------------------------------

static bool is_of_board(const table_service_t *self, const uint32_t *head) {
    return head[TABLE_FILE_BOARD] == 0u || head[TABLE_FILE_BOARD] == self->board;
}

static quiesce_table_verdict_t judge_file(const table_service_t *self, const uint32_t *file) {
    const uint32_t count = file[TABLE_FILE_WORDS];
    if (!table_file_is_head(file, count)) {
        return QUIESCE_TABLE_CRC;
    }
    return is_of_board(self, file) ? quiesce_table_check(&file[TABLE_FILE_HEAD_WORDS], count)
                                   : QUIESCE_TABLE_BOARD;
}

quiesce_table_verdict_t table_service_ship(table_service_t *self, quiesce_t *controller,
                                           const uint32_t *file) {
    const uint32_t *words = &file[TABLE_FILE_HEAD_WORDS];
    const quiesce_table_verdict_t verdict = judge_file(self, file);
    self->of[road_of(words, file[TABLE_FILE_WORDS])].refusal = verdict;
    if (verdict == QUIESCE_TABLE_OK) {
        quiesce_tables_ship(&self->tables, words);
        quiesce_tables_resume(&self->tables, controller);
    }
    return verdict;
}

// ---- requests -----------------------------------------------------------------------------------

typedef struct {
    table_service_t *self;
    quiesce_t *controller;
    const can_service_request_t *request;
    int32_t value; ///< of the reply
} work_t;

// What has arrived is the file that the request means.
static bool has_arrived(const work_t *work) {
    uint32_t count;
    const uint32_t *words = quiesce_tables_arrival(&work->self->tables, &count);
    return table_link_has_file(&work->self->link) && count > CRC_WORD &&
           words[CRC_WORD] == (uint32_t)work->request->value;
}

static quiesce_table_verdict_t judge_learnt(const work_t *work, const uint32_t *words,
                                            uint32_t count, bool is_used) {
    if (!learnt_is_whole(words, count)) {
        return QUIESCE_TABLE_CRC;
    }
    // Whether it is of the law's table and setting only a load tells; a check is content with a law
    // that learns.
    quiesce_learnt_t known;
    const bool fits = is_used ? learnt_put(words, count, work->controller)
                              : quiesce_learnt_save(work->controller, &known);
    return fits ? QUIESCE_TABLE_OK : QUIESCE_TABLE_FIT;
}

static quiesce_table_verdict_t judge(const work_t *work, bool is_used) {
    table_service_t *self = work->self;
    uint32_t count;
    const uint32_t *words = quiesce_tables_arrival(&self->tables, &count);
    if (!is_of_board(self, self->link.head)) {
        return QUIESCE_TABLE_BOARD;
    }
    if (is_learnt(words, count)) {
        return judge_learnt(work, words, count, is_used);
    }
    return is_used ? quiesce_tables_commit(&self->tables, work->controller)
                   : quiesce_tables_check(&self->tables, work->controller);
}

// TABLE_CHECK and TABLE_COMMIT. Returns false while it is summed.
static bool take_arrival(work_t *work, bool is_used, can_node_result_t *result) {
    table_service_t *self = work->self;
    uint32_t count;
    const uint32_t *words = quiesce_tables_arrival(&self->tables, &count);
    if (!has_arrived(work)) {
        *result = CAN_NODE_NOTHING_RECEIVED;
        return true;
    }
    if (!quiesce_tables_sum(&self->tables, SUMMED_A_TICK)) {
        return false;
    }
    const uint32_t road = road_of(words, count);
    const quiesce_table_verdict_t verdict = judge(work, is_used);
    self->of[road].refusal = verdict;
    work->value = (int32_t)verdict;
    *result = verdict == QUIESCE_TABLE_OK ? CAN_NODE_DONE : CAN_NODE_TABLE_REFUSED;
    if (is_used) {
        table_link_drop(&self->link);
        self->of[road].source =
            verdict == QUIESCE_TABLE_OK ? TABLE_FROM_CAN : self->of[road].source;
    }
    return true;
}

static can_node_result_t go_back(const work_t *work) {
    const quiesce_owner_t owner = (quiesce_owner_t)work->request->index;
    table_service_t *self = work->self;
    if (work->request->index >= ROAD_LEARNT) {
        return CAN_NODE_NO_SUCH_TABLE;
    }
    return quiesce_tables_revert(&self->tables, work->controller, owner) ? CAN_NODE_DONE
                                                                         : CAN_NODE_NOTHING_TO_SEND;
}

static can_node_result_t ship(const work_t *work) {
    const quiesce_owner_t owner = (quiesce_owner_t)work->request->index;
    if (work->request->index >= ROAD_LEARNT) {
        return CAN_NODE_NO_SUCH_TABLE;
    }
    return quiesce_tables_unload(&work->self->tables, work->controller, owner)
               ? CAN_NODE_DONE
               : CAN_NODE_NO_SUCH_TABLE;
}

// The words of a road to store; *count 0: the record is to be forgotten. Returns NULL with a count
// iff there is nothing to store.
static const uint32_t *words_to_store(const work_t *work, uint32_t *count) {
    table_service_t *self = work->self;
    const uint32_t road = work->request->index;
    const uint32_t *words = NULL;
    *count = 0;
    if (road == ROAD_LEARNT) {
        words = self->learnt.kept.words;
        *count = words[COUNT_WORD];
    } else if (quiesce_tables_is_loaded(&self->tables, work->controller, (quiesce_owner_t)road)) {
        words = quiesce_table_in_use(work->controller, (quiesce_owner_t)road);
        *count = words[COUNT_WORD];
    }
    return words;
}

// TABLE_SAVE. Returns false while it is written.
static bool store_road(const work_t *work, can_node_result_t *result) {
    table_service_t *self = work->self;
    const uint32_t road = work->request->index;
    uint32_t count;
    bool is_stored;
    if (road >= ROADS) {
        *result = CAN_NODE_NO_SUCH_TABLE;
        return true;
    }
    if (road == ROAD_LEARNT && !self->is_working && self->keeper.under_way != KEEPER_LEARNT &&
        !learnt_take(&self->learnt.kept, work->controller)) {
        *result = CAN_NODE_NOTHING_TO_SEND;
        return true;
    }
    const uint32_t *words = words_to_store(work, &count);
    const bool was_free = self->keeper.under_way == KEEPER_RECORDS;
    const bool has_outcome =
        keeper_ask(&self->keeper, record_of[road], count > 0u ? words[CRC_WORD] : 0u, words, count,
                   &is_stored);
    if (was_free && self->keeper.under_way == record_of[road]) { // it is read until it is stored
        quiesce_tables_hold(&self->tables, words);
    }
    if (!has_outcome) {
        return false;
    }
    *result = is_stored ? CAN_NODE_DONE : CAN_NODE_STORE_FAILED;
    return true;
}

void table_service_stored(table_service_t *self, bool is_stored) {
    keeper_stored(&self->keeper, is_stored);
    quiesce_tables_hold(&self->tables, NULL);
}

static const uint32_t *in_use(const work_t *work, uint32_t road) {
    table_service_t *self = work->self;
    if (road != ROAD_LEARNT) {
        return quiesce_table_in_use(work->controller, (quiesce_owner_t)road);
    }
    return learnt_take(&self->learnt.taken, work->controller) ? self->learnt.taken.words : NULL;
}

static uint32_t source_of(const work_t *work, uint32_t road) {
    const table_service_t *self = work->self;
    const bool is_loaded =
        road == ROAD_LEARNT ||
        quiesce_tables_is_loaded(&self->tables, work->controller, (quiesce_owner_t)road);
    return (uint32_t)(is_loaded ? self->of[road].source : TABLE_SHIPS);
}

static uint32_t info_of(const work_t *work, uint32_t road, const uint32_t *words) {
    const table_service_t *self = work->self;
    const keeper_record_t record = record_of[road];
    switch (work->request->value) {
    case TABLE_INFO_CRC:
        return words != NULL ? words[CRC_WORD] : 0u;
    case TABLE_INFO_MAGIC:
        return words != NULL ? words[0] : 0u;
    case TABLE_INFO_STORED_CRC:
        return self->keeper.kept[record].mark;
    case TABLE_INFO_SOURCE:
        return words != NULL ? source_of(work, road) : (uint32_t)TABLE_FROM_NOWHERE;
    case TABLE_INFO_BOARD:
        return self->board;
    case TABLE_INFO_WRITES:
        return self->keeper.kept[record].writes;
    case TABLE_INFO_RECORD:
        return (uint32_t)self->keeper.kept[record].state;
    case TABLE_INFO_REFUSAL:
    default:
        return (uint32_t)self->of[road].refusal;
    }
}

static can_node_result_t tell(work_t *work) {
    const uint32_t road = work->request->index;
    if (road >= ROADS || work->request->value < 0 || work->request->value >= TABLE_INFOS) {
        return CAN_NODE_NO_SUCH_TABLE;
    }
    work->value = (int32_t)info_of(work, road, in_use(work, road));
    return CAN_NODE_DONE;
}

static can_node_result_t send(work_t *work) {
    const uint32_t road = work->request->index;
    if (road >= ROADS) {
        return CAN_NODE_NO_SUCH_TABLE;
    }
    const uint32_t *words = in_use(work, road);
    if (words == NULL) {
        return CAN_NODE_NOTHING_TO_SEND;
    }
    work->value = (int32_t)table_link_send(&work->self->link, words, 0);
    return CAN_NODE_DONE;
}

static can_node_result_t restore_learnt(work_t *work) {
    const uint32_t *words = work->self->learnt.kept.words;
    if (words[COUNT_WORD] == 0u) {
        return CAN_NODE_NOTHING_TO_SEND;
    }
    if (learnt_put(words, words[COUNT_WORD], work->controller)) {
        work->self->of[ROAD_LEARNT].source = TABLE_FROM_STORE;
        return CAN_NODE_DONE;
    }
    work->value = (int32_t)QUIESCE_TABLE_FIT;
    return CAN_NODE_TABLE_REFUSED;
}

// Returns false while it has to wait.
static bool act(work_t *work, can_node_result_t *result) {
    switch (work->request->operation) {
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_CHECK_CHOICE:
        return take_arrival(work, false, result);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_COMMIT_CHOICE:
        return take_arrival(work, true, result);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SAVE_CHOICE:
        return store_road(work, result);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_REVERT_CHOICE:
        *result = go_back(work);
        return true;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SHIP_CHOICE:
        *result = ship(work);
        return true;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_INFO_CHOICE:
        *result = tell(work);
        return true;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_TABLE_SEND_CHOICE:
        *result = send(work);
        return true;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_LEARNT_RESTORE_CHOICE:
        *result = restore_learnt(work);
        return true;
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_LEARNT_FORGET_CHOICE:
    default:
        (void)quiesce_learnt_load(work->controller, NULL);
        *result = CAN_NODE_DONE;
        return true;
    }
}

bool table_service_work(table_service_t *self, quiesce_t *controller,
                        const can_service_request_t *request, can_node_result_t *result,
                        int32_t *value) {
    work_t work = {self, controller, request, 0};
    const bool is_done = act(&work, result);
    *value = work.value;
    self->is_working = !is_done;
    return is_done;
}

// ---- restarts, ticks ----------------------------------------------------------------------------

void table_service_before_restart(table_service_t *self, const quiesce_t *controller) {
    if (table_link_is_sending(&self->link, self->learnt.taken.words)) { // the host asks again
        table_link_drop(&self->link);
    }
    (void)learnt_take(&self->learnt.taken, controller);
}

static bool put_back(const learnt_t *learnt, quiesce_t *controller) {
    return learnt_put(learnt->words, learnt->words[COUNT_WORD], controller);
}

void table_service_after_restart(table_service_t *self, quiesce_t *controller) {
    const learnt_store_t *learnt = &self->learnt;
    quiesce_tables_resume(&self->tables, controller);
    for (uint32_t i = 0; i < QUIESCE_TABLE_OWNERS; i++) {
        if (quiesce_tables_is_loaded(&self->tables, controller, (quiesce_owner_t)i)) {
            self->of[i].refusal = QUIESCE_TABLE_OK; // it may have waited
        }
    }
    if (!put_back(&learnt->taken, controller)) {
        (void)put_back(&learnt->kept, controller);
    }
}

// Where it has changed it is stored, by and by.
static void keep_learnt(table_service_t *self, const quiesce_t *controller) {
    const uint32_t stored = self->keeper.kept[KEEPER_LEARNT].mark;
    if (self->keeper.store == NULL || self->keeper.under_way != KEEPER_RECORDS ||
        self->is_working || !learnt_take(&self->learnt.kept, controller) ||
        learnt_crc(&self->learnt.kept) == stored) {
        return;
    }
    const learnt_t *kept = &self->learnt.kept;
    if (keeper_begin(&self->keeper, KEEPER_LEARNT, learnt_crc(kept), kept->words,
                     kept->words[COUNT_WORD])) {
        learnt_wrote(&self->learnt);
    }
}

bool table_service_tick(table_service_t *self, const table_tick_t *tick, can_frame_t *frame) {
    const isotp_t *isotp = &self->link.isotp;
    if (learnt_is_due(&self->learnt)) {
        keep_learnt(self, tick->controller);
    }
    if (isotp_is_idle(isotp) || (isotp->owes_first && !tick->is_answered)) {
        return false;
    }
    return table_link_tick(&self->link, tick->passed_ms, &self->tables, frame);
}
