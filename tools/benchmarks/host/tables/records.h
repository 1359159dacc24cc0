/// What the node of this machine keeps: a file a record (keeper.h), each replaced as a whole or not
/// at all.
#ifndef TABLE_NODE_RECORDS_H
#define TABLE_NODE_RECORDS_H

#include "node.h"

typedef struct {
    const char *folder;
} records_t;

/// A keeper_store_t; context: the records_t.
keeper_answer_t records_store(void *context, keeper_record_t record, const uint32_t *words,
                              uint32_t count);

/// The parameters that were stored. Returns false iff there are none.
bool records_params(const records_t *self, quiesce_params_t *params);

/// Gives the node its tables and what was learnt; after node_init.
void records_resume(const records_t *self, node_t *node);

#endif
