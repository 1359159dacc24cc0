#include "quiesce.h"

#include <stddef.h>

#define SHIPPED 2u

static uint32_t spare_of(const quiesce_table_store_t *store) {
    return store->in_use == 0 ? 1u : 0;
}

void quiesce_table_store_init(quiesce_table_store_t *store) {
    store->filled = 0;
    store->in_use = SHIPPED;
    store->previous = SHIPPED;
}

bool quiesce_table_store_write(quiesce_table_store_t *store, uint32_t offset, const uint32_t *words,
                               uint32_t count) {
    if ((offset != 0 && offset != store->filled) || count > QUIESCE_TABLE_WORDS ||
        offset > QUIESCE_TABLE_WORDS - count) {
        return false;
    }
    const uint32_t spare = spare_of(store);
    if (store->previous == spare) {
        store->previous = store->in_use;
    }
    for (uint32_t i = 0; i < count; i++) {
        store->words[spare][offset + i] = words[i];
    }
    store->filled = offset + count;
    return true;
}

// What ships is of the kind that is in use now: tables of other kinds are none of this store's.
static quiesce_table_verdict_t use_slot(const quiesce_table_store_t *store, quiesce_t *self,
                                        uint32_t slot, uint32_t count) {
    if (slot != SHIPPED) {
        return quiesce_table_use(self, store->words[slot], count);
    }
    return store->in_use != SHIPPED ? quiesce_table_drop(self, store->words[store->in_use][0])
                                    : quiesce_table_use(self, NULL, 0);
}

// What is in use must not become the spare slot: a table of another kind would not take its place.
static bool is_same_kind(const quiesce_table_store_t *store, uint32_t spare) {
    return store->in_use == SHIPPED || store->filled == 0 ||
           store->words[spare][0] == store->words[store->in_use][0];
}

quiesce_table_verdict_t quiesce_table_store_commit(quiesce_table_store_t *store, quiesce_t *self) {
    const uint32_t spare = spare_of(store);
    const quiesce_table_verdict_t verdict = is_same_kind(store, spare)
                                                ? use_slot(store, self, spare, store->filled)
                                                : QUIESCE_TABLE_MAGIC;
    store->filled = 0;
    if (verdict == QUIESCE_TABLE_OK) {
        store->previous = store->in_use;
        store->in_use = spare;
    }
    return verdict;
}

void quiesce_table_store_revert(quiesce_table_store_t *store, quiesce_t *self) {
    store->filled = 0; // the other slot is the spare one from now on
    if (use_slot(store, self, store->previous, QUIESCE_TABLE_WORDS) == QUIESCE_TABLE_OK) {
        store->in_use = store->previous;
    }
}
