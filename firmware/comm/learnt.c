#include "learnt.h"

#include <stddef.h>

#include "crc32.h"

enum { MAGIC, CRC, COUNT, HEAD_WORDS };

void learnt_init(learnt_store_t *self) {
    *self = (learnt_store_t){.left_s = LEARNT_FIRST_S, .pause_s = LEARNT_FIRST_S};
}

bool learnt_take(learnt_t *self, const quiesce_t *controller) {
    quiesce_learnt_t learnt;
    if (!quiesce_learnt_save(controller, &learnt)) {
        return false;
    }
    *self = (learnt_t){{0}};
    self->words[MAGIC] = TABLE_FILE_LEARNT;
    self->words[COUNT] = HEAD_WORDS + learnt.count;
    for (uint32_t i = 0; i < learnt.count; i++) {
        self->words[HEAD_WORDS + i] = learnt.words[i];
    }
    self->words[CRC] = crc32_words(&self->words[COUNT], self->words[COUNT] - COUNT);
    return true;
}

bool learnt_is_whole(const uint32_t *words, uint32_t count) {
    return count > HEAD_WORDS && count <= LEARNT_MOST_WORDS && words[MAGIC] == TABLE_FILE_LEARNT &&
           words[COUNT] == count && words[CRC] == crc32_words(&words[COUNT], count - COUNT);
}

bool learnt_put(const uint32_t *words, uint32_t count, quiesce_t *controller) {
    quiesce_learnt_t learnt = {0};
    if (!learnt_is_whole(words, count)) {
        return false;
    }
    learnt.count = count - HEAD_WORDS;
    for (uint32_t i = 0; i < learnt.count; i++) {
        learnt.words[i] = words[HEAD_WORDS + i];
    }
    return quiesce_learnt_load(controller, &learnt);
}

bool learnt_is_due(learnt_store_t *self) {
    if (self->passed_ms < LEARNT_LOOK_MS) {
        return false;
    }
    self->passed_ms -= LEARNT_LOOK_MS;
    self->left_s--;
    if (self->left_s > 0u) {
        return false;
    }
    self->left_s = LEARNT_FIRST_S;
    return true;
}

void learnt_wrote(learnt_store_t *self) {
    self->pause_s = self->pause_s < LEARNT_SLOWEST_S / 2u ? 2u * self->pause_s : LEARNT_SLOWEST_S;
    self->left_s = self->pause_s;
}
