#include "image_service.h"

#include <stddef.h>

#include "quiesce_can.h"

#define SUMMED_A_TICK 16u ///< words, some 1,000 instructions
#define GRID 4u           ///< places of pieces

enum { PIECE_MAGIC, PIECE_CRC, PIECE_COUNT, PIECE_AT };

// What the store answers, as a reply; false while it works.
static bool told(image_store_answer_t answer, can_node_result_t *result) {
    switch (answer) {
    case IMAGE_STORE_BUSY:
        return false;
    case IMAGE_STORE_DONE:
        *result = CAN_NODE_DONE;
        return true;
    case IMAGE_STORE_REFUSED:
        *result = CAN_NODE_IMAGE_REFUSED;
        return true;
    case IMAGE_STORE_FAILED:
    default:
        *result = CAN_NODE_STORE_FAILED;
        return true;
    }
}

static bool prepare_place(image_service_t *self, can_node_result_t *result) {
    if (!self->is_awaited && self->stage != IMAGE_STAGE_ERASES) {
        self->stage = IMAGE_STAGE_ERASES;
        self->written = 0;
        self->quiet_ms = IMAGE_SERVICE_QUIET_MS;
    }
    self->is_awaited = true;
    if (self->stage == IMAGE_STAGE_ERASES) {
        return false;
    }
    self->is_awaited = false;
    return told(self->erased, result);
}

// What has arrived is the piece that the request means.
static bool has_arrived(const image_work_t *work, const uint32_t *words, uint32_t count) {
    return table_link_has_file(work->link) && count > IMAGE_PIECE_HEAD_WORDS &&
           words[PIECE_MAGIC] == IMAGE_PIECE_MAGIC && words[PIECE_COUNT] == count &&
           words[PIECE_CRC] == (uint32_t)work->request->value;
}

// The next one, or the last one again, whose reply was lost.
static bool is_in_place(const image_service_t *self, uint32_t at, uint32_t count) {
    return count <= IMAGE_PIECE_WORDS && at % GRID == 0u &&
           (at == self->written || (at < self->written && at + count == self->written));
}

static bool take_piece(image_service_t *self, const image_work_t *work, can_node_result_t *result) {
    uint32_t count;
    const uint32_t *words = quiesce_tables_arrival(work->tables, &count);
    if (self->stage != IMAGE_STAGE_OPEN || !has_arrived(work, words, count)) {
        *result = CAN_NODE_NOTHING_RECEIVED;
        return true;
    }
    if (!quiesce_tables_sum(work->tables, SUMMED_A_TICK)) {
        return false;
    }
    const uint32_t at = words[PIECE_AT];
    const uint32_t image_words = count - IMAGE_PIECE_HEAD_WORDS;
    if (work->tables->crc != words[PIECE_CRC]) {
        *result = CAN_NODE_NOTHING_RECEIVED;
        return true;
    }
    if (!is_in_place(self, at, image_words)) {
        *result = CAN_NODE_OUT_OF_RANGE;
        return true;
    }
    self->quiet_ms = IMAGE_SERVICE_QUIET_MS;
    if (!told(self->store->write(self->store->context, at, &words[IMAGE_PIECE_HEAD_WORDS],
                                 image_words),
              result)) {
        return false;
    }
    self->written = *result == CAN_NODE_DONE ? at + image_words : self->written;
    return true;
}

// Asked again, its reply was lost.
static bool finish_image(image_service_t *self, can_node_result_t *result) {
    if (self->stage != IMAGE_STAGE_OPEN) {
        *result = self->stage == IMAGE_STAGE_FINISHED ? CAN_NODE_DONE : CAN_NODE_NOTHING_RECEIVED;
        return true;
    }
    if (!told(self->store->finish(self->store->context), result)) {
        return false;
    }
    self->stage = *result == CAN_NODE_DONE ? IMAGE_STAGE_FINISHED : IMAGE_STAGE_NONE;
    return true;
}

// Not of an image on trial, whose last start it would be.
static can_node_result_t start_again(image_service_t *self) {
    if (self->is_held) {
        return CAN_NODE_IMAGE_REFUSED;
    }
    if (!self->is_starting) {
        self->store->start(self->store->context);
    }
    self->is_starting = true;
    return CAN_NODE_DONE;
}

static can_node_result_t tell_of(const image_service_t *self, uint32_t what, int32_t *value) {
    if (what >= IMAGE_INFOS) {
        return CAN_NODE_NO_SUCH_TABLE;
    }
    *value = (int32_t)(what == IMAGE_INFO_WORDS
                           ? self->written
                           : self->store->tell(self->store->context, (image_info_number_t)what));
    return CAN_NODE_DONE;
}

// What is under way may go on to its end.
static bool leads_to_restart(uint8_t operation) {
    return operation == QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_PREPARE_CHOICE ||
           operation == QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_START_CHOICE;
}

bool image_service_work(image_service_t *self, const image_work_t *work, can_node_result_t *result,
                        int32_t *value) {
    const uint8_t operation = work->request->operation;
    if (operation == QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_INFO_CHOICE) {
        *result = tell_of(self, work->request->index, value);
        return true;
    }
    if (work->is_armed) {
        *result = CAN_NODE_IS_ARMED;
        return true;
    }
    if (work->has_latched_fault && leads_to_restart(operation)) {
        *result = CAN_NODE_FAULT_IS_LATCHED;
        return true;
    }
    switch (operation) {
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_PREPARE_CHOICE:
        return prepare_place(self, result);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_PIECE_CHOICE:
        return take_piece(self, work, result);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_FINISH_CHOICE:
        return finish_image(self, result);
    case QUIESCE_CAN_SERVICE_REQUEST_OPERATION_IMAGE_START_CHOICE:
    default:
        *result = start_again(self);
        return true;
    }
}

// A store that does not come to an end is told as failed.
static void erase(image_service_t *self) {
    const image_store_answer_t answer = self->store->prepare(self->store->context);
    if (answer == IMAGE_STORE_BUSY && self->quiet_ms > 0u) {
        return;
    }
    self->erased = answer == IMAGE_STORE_BUSY ? IMAGE_STORE_FAILED : answer;
    self->stage = answer == IMAGE_STORE_DONE ? IMAGE_STAGE_OPEN : IMAGE_STAGE_NONE;
    self->quiet_ms = IMAGE_SERVICE_QUIET_MS;
}

void image_service_go_on(image_service_t *self, uint32_t passed_ms) {
    self->quiet_ms -= passed_ms < self->quiet_ms ? passed_ms : self->quiet_ms;
    if (self->stage == IMAGE_STAGE_ERASES) {
        erase(self);
    } else if (self->quiet_ms == 0u) {
        self->stage = IMAGE_STAGE_NONE;
    }
}

void image_service_use(image_service_t *self, const image_store_t *store) {
    self->store = store;
    self->work = store != NULL ? image_service_work : NULL;
    self->go_on = store != NULL ? image_service_go_on : NULL;
}
