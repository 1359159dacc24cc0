#include "keeper.h"

#include <stddef.h>

#include "fixq.h"

void keeper_init(keeper_t *self) {
    *self = (keeper_t){.under_way = KEEPER_RECORDS};
}

void keeper_found(keeper_t *self, keeper_record_t record, uint32_t mark, uint32_t writes) {
    self->kept[record].mark = mark;
    self->kept[record].writes = writes;
}

void keeper_stored(keeper_t *self, bool is_stored) {
    const keeper_record_t record = self->under_way;
    if (record == KEEPER_RECORDS) {
        return;
    }
    if (is_stored) {
        self->kept[record].mark = self->mark;
        self->kept[record].writes = increment_sat_u32(self->kept[record].writes);
        self->kept[record].state = KEEPER_WHOLE;
    }
    self->under_way = KEEPER_RECORDS;
    self->has_outcome = self->is_awaited;
    self->is_stored = is_stored;
    self->is_awaited = false;
}

bool keeper_begin(keeper_t *self, keeper_record_t record, uint32_t mark, const uint32_t *words,
                  uint32_t count) {
    if (self->under_way != KEEPER_RECORDS) {
        return false;
    }
    const keeper_answer_t answer =
        self->store != NULL ? self->store(self->context, record, words, count) : KEEPER_FAILED;
    if (answer == KEEPER_BUSY) {
        return false;
    }
    self->under_way = record;
    self->mark = mark;
    if (answer != KEEPER_BEGUN) {
        keeper_stored(self, answer == KEEPER_DONE);
    }
    return true;
}

bool keeper_ask(keeper_t *self, keeper_record_t record, uint32_t mark, const uint32_t *words,
                uint32_t count, bool *is_stored) {
    if (!self->is_awaited && !self->has_outcome) {
        self->is_awaited = self->under_way == KEEPER_RECORDS;
        if (self->is_awaited && !keeper_begin(self, record, mark, words, count)) {
            self->is_awaited = false;
        }
    }
    const bool has_outcome = self->has_outcome;
    *is_stored = self->is_stored;
    self->has_outcome = false;
    return has_outcome;
}
