#include "records.h"

#include "nvm_file.h"

#include <stdio.h>
#include <string.h>

#define VERSION 1u

typedef struct {
    uint32_t writes;
    uint32_t count; ///< 0: forgotten
    uint32_t words[QUIESCE_TABLE_WORDS];
} kept_t;

static void name(const records_t *self, keeper_record_t record, char path[256]) {
    (void)snprintf(path, 256, "%s/record%u.bin", self->folder, (unsigned)record);
}

static kept_t kept_of(const records_t *self, keeper_record_t record) {
    char path[256];
    kept_t kept;
    name(self, record, path);
    if (nvm_file_read(path, "table", VERSION, &kept, sizeof kept, NULL) != NVM_OK) {
        kept = (kept_t){0};
    }
    return kept;
}

keeper_answer_t records_store(void *context, keeper_record_t record, const uint32_t *words,
                              uint32_t count) {
    const records_t *const self = context;
    char path[256];
    kept_t kept = {.writes = kept_of(self, record).writes + 1u, .count = count};
    if (count > QUIESCE_TABLE_WORDS) {
        return KEEPER_FAILED;
    }
    if (count > 0u) {
        memcpy(kept.words, words, count * sizeof *words);
    }
    name(self, record, path);
    return nvm_file_write(path, "table", VERSION, &kept, sizeof kept, NULL) ? KEEPER_DONE
                                                                            : KEEPER_FAILED;
}

bool records_params(const records_t *self, quiesce_params_t *params) {
    const kept_t kept = kept_of(self, KEEPER_PARAMS);
    const bool is_there = kept.count == QUIESCE_PARAM_COUNT;
    if (is_there) {
        memcpy(params, kept.words, sizeof *params);
    }
    return is_there;
}

void records_resume(const records_t *self, node_t *node) {
    for (uint32_t record = KEEPER_LAW_TABLE; record < KEEPER_RECORDS; record++) {
        const kept_t kept = kept_of(self, (keeper_record_t)record);
        const table_found_t found = {(keeper_record_t)record, TABLE_FROM_STORE, kept.words,
                                     kept.count, kept.writes};
        (void)node_found(node, &found);
    }
}
