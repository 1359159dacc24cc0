#include "nvm_records.h"

#include <stddef.h>

#include "crc32.h"

#define SLOTS 2u

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static uint32_t slot_words(uint32_t block_words) {
    const uint32_t words = NVM_HEAD_WORDS + HAL_NVM_MAX_WORDS;
    return (words + block_words - 1u) / block_words * block_words;
}

uint32_t nvm_records_words(uint32_t block_words) {
    return HAL_NVM_RECORDS * SLOTS * slot_words(block_words);
}

bool nvm_records_open(hal_nvm_t *nvm, hal_nvm_memory_t *memory, uint32_t owner) {
    const uint32_t block_words = hal_nvm_memory_block_words(memory);
    *nvm = (hal_nvm_t){.memory = memory, .slot_words = slot_words(block_words), .owner = owner};
    return hal_nvm_memory_words(memory) >= nvm_records_words(block_words);
}

static uint32_t slot_at(const hal_nvm_t *nvm, uint32_t record, uint32_t slot) {
    return (record * SLOTS + slot) * nvm->slot_words;
}

static uint32_t magic_of(uint32_t record) {
    return NVM_MAGIC + (record << 24);
}

// Of the owner and the head but its first word; the record's words follow.
static uint32_t crc_of_head(const hal_nvm_t *nvm, const uint32_t head[NVM_HEAD_WORDS]) {
    return crc32_continue(crc32_words(&nvm->owner, 1), &head[NVM_HEAD_SEQUENCE],
                          NVM_HEAD_WORDS - NVM_HEAD_SEQUENCE);
}

// Sequence numbers go round.
static bool is_after(uint32_t sequence, uint32_t other) {
    return (int32_t)(sequence - other) > 0;
}

typedef uint32_t heads_t[SLOTS][NVM_HEAD_WORDS];

static void read_heads(hal_nvm_t *nvm, uint32_t record, heads_t head) {
    for (uint32_t slot = 0; slot < SLOTS; slot++) {
        if (!hal_nvm_memory_read(nvm->memory, slot_at(nvm, record, slot), head[slot],
                                 NVM_HEAD_WORDS)) {
            head[slot][NVM_HEAD_MAGIC] = 0;
        }
    }
}

static uint32_t newer_of(const heads_t head, uint32_t magic) {
    const bool has_0 = head[0][NVM_HEAD_MAGIC] == magic;
    const bool has_1 = head[1][NVM_HEAD_MAGIC] == magic;
    return has_1 && (!has_0 || is_after(head[1][NVM_HEAD_SEQUENCE], head[0][NVM_HEAD_SEQUENCE]))
               ? 1u
               : 0u;
}

// Copies the record's words to words, unless that is NULL: what is copied is what was checked.
static bool is_whole(hal_nvm_t *nvm, uint32_t record, uint32_t slot,
                     const uint32_t head[NVM_HEAD_WORDS], uint32_t *words) {
    uint32_t part[HAL_NVM_SLICE_WORDS];
    const uint32_t at = slot_at(nvm, record, slot) + NVM_HEAD_WORDS;
    const uint32_t count = head[NVM_HEAD_COUNT];
    uint32_t crc = crc_of_head(nvm, head);
    if (head[NVM_HEAD_MAGIC] != magic_of(record) || count > HAL_NVM_MAX_WORDS) {
        return false;
    }
    for (uint32_t done = 0; done < count; done += HAL_NVM_SLICE_WORDS) {
        const uint32_t length = least(count - done, HAL_NVM_SLICE_WORDS);
        if (!hal_nvm_memory_read(nvm->memory, at + done, part, length)) {
            return false;
        }
        crc = crc32_continue(crc, part, length);
        for (uint32_t i = 0; words != NULL && i < length; i++) {
            words[done + i] = part[i];
        }
    }
    return crc == head[NVM_HEAD_CRC];
}

// Whether the slot beside a whole one of that sequence number may have held the write after it.
static bool is_suspect(hal_nvm_t *nvm, uint32_t record, uint32_t slot,
                       const uint32_t head[NVM_HEAD_WORDS], uint32_t sequence) {
    const bool was_written =
        head[NVM_HEAD_MAGIC] == magic_of(record) || head[NVM_HEAD_SEQUENCE] == sequence + 1u;
    return was_written && !is_whole(nvm, record, slot, head, NULL);
}

static void note(hal_nvm_t *nvm, uint32_t record, uint32_t sequence, uint32_t slot) {
    nvm->record[record].is_read = true;
    nvm->record[record].sequence = sequence;
    nvm->record[record].next_slot = 1u - slot;
}

hal_nvm_found_t hal_nvm_read(hal_nvm_t *nvm, uint32_t record, uint32_t *words, uint32_t *count) {
    heads_t head;
    *count = 0;
    if (record >= HAL_NVM_RECORDS) {
        return HAL_NVM_NONE;
    }
    read_heads(nvm, record, head);
    const uint32_t newer = newer_of((const uint32_t(*)[NVM_HEAD_WORDS])head, magic_of(record));
    for (uint32_t i = 0; i < SLOTS; i++) {
        const uint32_t slot = newer ^ i;
        const uint32_t other = 1u - slot;
        const uint32_t sequence = head[slot][NVM_HEAD_SEQUENCE];
        if (is_whole(nvm, record, slot, head[slot], words)) {
            note(nvm, record, sequence, slot);
            *count = head[slot][NVM_HEAD_COUNT];
            return is_suspect(nvm, record, other, head[other], sequence) ? HAL_NVM_OLDER
                                                                         : HAL_NVM_KEPT;
        }
    }
    const bool was_written = head[newer][NVM_HEAD_MAGIC] == magic_of(record);
    note(nvm, record, was_written ? head[newer][NVM_HEAD_SEQUENCE] : 0u, newer);
    return was_written ? HAL_NVM_LOST : HAL_NVM_NONE;
}

bool hal_nvm_begin(hal_nvm_t *nvm, uint32_t record, const uint32_t *words, uint32_t count) {
    if (nvm->phase != NVM_REST || record >= HAL_NVM_RECORDS || !nvm->record[record].is_read ||
        count > HAL_NVM_MAX_WORDS) {
        return false;
    }
    nvm->phase = NVM_ERASE;
    nvm->writing = record;
    nvm->done = 0;
    nvm->words = words;
    nvm->head[NVM_HEAD_SEQUENCE] = nvm->record[record].sequence + 1u;
    nvm->head[NVM_HEAD_COUNT] = count;
    nvm->head[NVM_HEAD_MAGIC] = magic_of(record);
    nvm->head[NVM_HEAD_CRC] = crc_of_head(nvm, nvm->head);
    return true;
}

static uint32_t place(const hal_nvm_t *nvm) {
    return slot_at(nvm, nvm->writing, nvm->record[nvm->writing].next_slot);
}

// The head's block first: what is left of the slot before it counts no longer.
static hal_nvm_progress_t erase(hal_nvm_t *nvm) {
    const hal_nvm_progress_t step = hal_nvm_memory_erase(nvm->memory, place(nvm) + nvm->done);
    if (step != HAL_NVM_DONE) {
        return step;
    }
    nvm->done += hal_nvm_memory_block_words(nvm->memory);
    if (nvm->done >= NVM_HEAD_WORDS + nvm->head[NVM_HEAD_COUNT]) {
        nvm->phase = nvm->head[NVM_HEAD_COUNT] == 0u ? NVM_HEAD : NVM_WORDS;
        nvm->done = 0;
    }
    return HAL_NVM_BUSY;
}

// Programs and compares.
static hal_nvm_progress_t put(hal_nvm_t *nvm, uint32_t at, const uint32_t *words, uint32_t count) {
    uint32_t back[HAL_NVM_SLICE_WORDS];
    const hal_nvm_progress_t step = hal_nvm_memory_program(nvm->memory, at, words, count);
    if (step != HAL_NVM_DONE) {
        return step;
    }
    if (!hal_nvm_memory_read(nvm->memory, at, back, count)) {
        return HAL_NVM_FAILED;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (back[i] != words[i]) {
            return HAL_NVM_FAILED;
        }
    }
    return HAL_NVM_DONE;
}

static hal_nvm_progress_t put_words(hal_nvm_t *nvm) {
    const uint32_t left = nvm->head[NVM_HEAD_COUNT] - nvm->done;
    const uint32_t count = least(left, HAL_NVM_SLICE_WORDS);
    const uint32_t *const words = &nvm->words[nvm->done];
    const hal_nvm_progress_t step = put(nvm, place(nvm) + NVM_HEAD_WORDS + nvm->done, words, count);
    if (step != HAL_NVM_DONE) {
        return step;
    }
    nvm->head[NVM_HEAD_CRC] = crc32_continue(nvm->head[NVM_HEAD_CRC], words, count);
    nvm->done += count;
    nvm->phase = count == left ? NVM_HEAD : NVM_WORDS;
    return HAL_NVM_BUSY;
}

static hal_nvm_progress_t put_head(hal_nvm_t *nvm) {
    const hal_nvm_progress_t step = put(nvm, place(nvm), nvm->head, NVM_HEAD_WORDS);
    if (step == HAL_NVM_DONE) {
        nvm->record[nvm->writing].sequence++;
        nvm->record[nvm->writing].next_slot ^= 1u;
    }
    return step;
}

static hal_nvm_progress_t advance(hal_nvm_t *nvm) {
    switch (nvm->phase) {
    case NVM_ERASE:
        return erase(nvm);
    case NVM_WORDS:
        return put_words(nvm);
    case NVM_HEAD:
        return put_head(nvm);
    case NVM_REST:
    default:
        return HAL_NVM_IDLE;
    }
}

hal_nvm_progress_t hal_nvm_work(hal_nvm_t *nvm) {
    const hal_nvm_progress_t step = advance(nvm);
    if (step != HAL_NVM_BUSY) {
        nvm->phase = NVM_REST;
    }
    return step;
}

uint32_t hal_nvm_writes(const hal_nvm_t *nvm, uint32_t record) {
    return record < HAL_NVM_RECORDS ? nvm->record[record].sequence : 0u;
}
