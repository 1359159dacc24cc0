#include "nvm_records.h"

#include <stddef.h>

#include "crc32.h"

#define HALVES 2u
#define TAIL_WORDS 2u
#define TAIL_ROOM 4u
#define ERASED UINT32_MAX

typedef uint32_t head_t[NVM_HEAD_WORDS];

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static uint32_t up_to(uint32_t count, uint32_t step) {
    return (count + step - 1u) / step * step;
}

// Of an entry's head and its words: where its tail is.
static uint32_t tail_in(uint32_t count) {
    return NVM_HEAD_WORDS + up_to(count, NVM_HEAD_WORDS);
}

static uint32_t entry_words(uint32_t count) {
    return tail_in(count) + TAIL_ROOM;
}

uint32_t nvm_records_words(uint32_t block_words) {
    // With each record a mark that it is doubted.
    const uint32_t longest = entry_words(HAL_NVM_MAX_WORDS) + entry_words(0);
    return HALVES * up_to(NVM_FIRST_AT + HAL_NVM_RECORDS * longest, block_words);
}

static void make_head(head_t head, uint32_t magic, uint32_t count, uint32_t number) {
    head[NVM_HEAD_MAGIC] = magic;
    head[NVM_HEAD_COUNT] = count;
    head[NVM_HEAD_NUMBER] = number;
    head[NVM_HEAD_CRC] = crc32_words(head, NVM_HEAD_CRC);
}

static bool is_head(const head_t head) {
    return head[NVM_HEAD_CRC] == crc32_words(head, NVM_HEAD_CRC);
}

static bool read_log(const hal_nvm_t *nvm, uint32_t at, uint32_t *words, uint32_t count) {
    return hal_nvm_memory_read(nvm->memory, nvm->half * nvm->half_words + at, words, count);
}

// 0: it has none. Of its two heads one is enough, so that no single bit takes all records away.
static uint32_t number_of(const hal_nvm_t *nvm, uint32_t half) {
    head_t head;
    for (uint32_t at = 0; at < NVM_FIRST_AT; at += NVM_HEAD_WORDS) {
        if (hal_nvm_memory_read(nvm->memory, half * nvm->half_words + at, head, NVM_HEAD_WORDS) &&
            is_head(head) && head[NVM_HEAD_MAGIC] == NVM_HALF) {
            return head[NVM_HEAD_NUMBER];
        }
    }
    return 0;
}

// Numbers go round.
static bool is_after(uint32_t number, uint32_t other) {
    return (int32_t)(number - other) > 0;
}

static uint32_t crc_of_head(const hal_nvm_t *nvm, const head_t head) {
    return crc32_continue(crc32_words(&nvm->owner, 1), head, NVM_HEAD_WORDS);
}

// Copies the record's words to words, unless that is NULL: what is copied is what was checked.
static bool is_whole(const hal_nvm_t *nvm, uint32_t at, const head_t head, uint32_t *words) {
    uint32_t part[HAL_NVM_SLICE_WORDS];
    const uint32_t count = head[NVM_HEAD_COUNT];
    uint32_t crc = crc_of_head(nvm, head);
    for (uint32_t done = 0; done < count; done += HAL_NVM_SLICE_WORDS) {
        const uint32_t length = least(count - done, HAL_NVM_SLICE_WORDS);
        if (!read_log(nvm, at + NVM_HEAD_WORDS + done, part, length)) {
            return false;
        }
        crc = crc32_continue(crc, part, length);
        for (uint32_t i = 0; words != NULL && i < length; i++) {
            words[done + i] = part[i];
        }
    }
    // A weak last word counts as the start has found it: whoever copies does not ask again.
    return read_log(nvm, at + tail_in(count), part, TAIL_WORDS) && part[0] == crc &&
           (part[1] == NVM_WHOLE || words != NULL);
}

static bool is_entry(const hal_nvm_t *nvm, uint32_t at, const head_t head) {
    return is_head(head) && head[NVM_HEAD_MAGIC] - NVM_ENTRY < HAL_NVM_RECORDS &&
           head[NVM_HEAD_COUNT] <= HAL_NVM_MAX_WORDS &&
           entry_words(head[NVM_HEAD_COUNT]) <= nvm->half_words - at;
}

// Returns the words to the next place where an entry may begin.
static uint32_t take_entry(hal_nvm_t *nvm, uint32_t at, const head_t head, bool is_good) {
    const uint32_t record = head[NVM_HEAD_MAGIC] - NVM_ENTRY;
    const uint32_t count = head[NVM_HEAD_COUNT];
    const uint32_t end = at + entry_words(count);
    nvm->is_last_whole = is_good;
    nvm->last_at = at;
    nvm->last_tail_at = at + tail_in(count);
    nvm->end = nvm->end > end ? nvm->end : end;
    nvm->record[record].writes = head[NVM_HEAD_NUMBER];
    nvm->record[record].is_doubted = !is_good;
    if (!is_good) {
        return NVM_HEAD_WORDS;
    }
    nvm->record[record].at = at;
    nvm->record[record].count = (uint16_t)count;
    return end - at;
}

static bool is_erased(const head_t words) {
    return (words[0] & words[1] & words[2] & words[3]) == ERASED;
}

// What is left of a head, whoever's it was, casts doubt on all records before it.
static void take_rest(hal_nvm_t *nvm, uint32_t at) {
    nvm->end = at + NVM_HEAD_WORDS;
    for (uint32_t i = 0; i < HAL_NVM_RECORDS; i++) {
        nvm->record[i].is_doubted |= nvm->record[i].at != 0u;
    }
}

// Goes on behind what is no entry, and so finds those after a damaged one.
static void walk(hal_nvm_t *nvm) {
    head_t head;
    nvm->end = NVM_FIRST_AT;
    for (uint32_t at = nvm->end; at <= nvm->half_words - NVM_HEAD_WORDS;) {
        uint32_t step = NVM_HEAD_WORDS;
        const bool is_read = read_log(nvm, at, head, NVM_HEAD_WORDS);
        if (is_read && is_entry(nvm, at, head)) {
            step = take_entry(nvm, at, head, is_whole(nvm, at, head, NULL));
        } else if (at >= nvm->end && !(is_read && is_erased(head))) {
            take_rest(nvm, at);
        }
        at += step;
    }
    nvm->end += NVM_HEAD_WORDS; // a word there may have been begun that still reads as erased
}

bool nvm_records_open(hal_nvm_t *nvm, hal_nvm_memory_t *memory, uint32_t owner) {
    const uint32_t block_words = hal_nvm_memory_block_words(memory);
    const uint32_t words = hal_nvm_memory_words(memory);
    *nvm = (hal_nvm_t){.memory = memory, .owner = owner};
    if (words < nvm_records_words(block_words)) {
        return false;
    }
    nvm->half_words = words / HALVES / block_words * block_words;
    const uint32_t number[HALVES] = {number_of(nvm, 0), number_of(nvm, 1)};
    nvm->half = number[1] != 0u && (number[0] == 0u || is_after(number[1], number[0])) ? 1u : 0u;
    nvm->number = number[nvm->half];
    if (nvm->number != 0u) {
        walk(nvm);
    }
    return true;
}

hal_nvm_found_t hal_nvm_read(hal_nvm_t *nvm, uint32_t record, uint32_t *words, uint32_t room,
                             uint32_t *count) {
    head_t head;
    *count = 0;
    if (record >= HAL_NVM_RECORDS) {
        return HAL_NVM_NONE;
    }
    const uint32_t at = nvm->record[record].at;
    if (at == 0u) {
        return nvm->record[record].is_doubted ? HAL_NVM_LOST : HAL_NVM_NONE;
    }
    if (!read_log(nvm, at, head, NVM_HEAD_WORDS) || !is_entry(nvm, at, head) ||
        head[NVM_HEAD_COUNT] > room || !is_whole(nvm, at, head, words)) {
        return HAL_NVM_LOST;
    }
    *count = head[NVM_HEAD_COUNT];
    return nvm->record[record].is_doubted ? HAL_NVM_OLDER : HAL_NVM_KEPT;
}

static bool has_room(const hal_nvm_t *nvm) {
    return nvm->end <= nvm->half_words &&
           entry_words(nvm->head[NVM_HEAD_COUNT]) <= nvm->half_words - nvm->end;
}

// Where the entry goes: behind the others, or behind their copies in the other half.
static void choose_place(hal_nvm_t *nvm) {
    const bool stays = nvm->number != 0u && has_room(nvm);
    nvm->to = stays ? nvm->half : 1u - nvm->half;
    nvm->place = stays ? nvm->end : NVM_FIRST_AT;
    nvm->phase = stays ? NVM_ENTRY_HEAD : NVM_ERASE;
    nvm->copying = 0;
    nvm->done = 0;
}

// A phase that writes both heads of a half.
static void begin_heads(hal_nvm_t *nvm, nvm_phase_t phase, uint32_t half) {
    nvm->phase = phase;
    nvm->to = half;
    nvm->bad_heads = 0;
    nvm->done = 0;
}

bool hal_nvm_begin(hal_nvm_t *nvm, uint32_t record, const uint32_t *words, uint32_t count) {
    if (nvm->phase != NVM_REST || nvm->half_words == 0u || record >= HAL_NVM_RECORDS ||
        count > HAL_NVM_MAX_WORDS) {
        return false;
    }
    nvm->writing = record;
    nvm->words = words;
    make_head(nvm->head, NVM_ENTRY + record, count, nvm->record[record].writes + 1u);
    nvm->crc = crc_of_head(nvm, nvm->head);
    if (nvm->number != 0u && !nvm->is_mended) {
        begin_heads(nvm, NVM_MEND_HALF, nvm->half);
    } else {
        choose_place(nvm);
    }
    return true;
}

// Programs words of the half that is written to, and notes BUSY or FAILED. Returns whether they are
// there.
static bool program(hal_nvm_t *nvm, uint32_t at, const uint32_t *words, uint32_t count) {
    const hal_nvm_progress_t step =
        hal_nvm_memory_program(nvm->memory, nvm->to * nvm->half_words + at, words, count);
    nvm->step = step == HAL_NVM_FAILED ? HAL_NVM_FAILED : HAL_NVM_BUSY;
    return step == HAL_NVM_DONE;
}

// Programs and compares.
static bool put(hal_nvm_t *nvm, uint32_t at, const uint32_t *words, uint32_t count) {
    uint32_t back[HAL_NVM_SLICE_WORDS];
    if (!program(nvm, at, words, count)) {
        return false;
    }
    bool is_same = hal_nvm_memory_read(nvm->memory, nvm->to * nvm->half_words + at, back, count);
    for (uint32_t i = 0; i < count; i++) {
        is_same = is_same && back[i] == words[i];
    }
    nvm->step = is_same ? HAL_NVM_BUSY : HAL_NVM_FAILED;
    return is_same;
}

// One of the two heads. Returns whether both are done; one of them is enough, where the other one
// has been damaged.
static bool put_number(hal_nvm_t *nvm, uint32_t number) {
    head_t head;
    make_head(head, NVM_HALF, 0, number);
    if (!put(nvm, nvm->done, head, NVM_HEAD_WORDS)) {
        nvm->bad_heads += nvm->step == HAL_NVM_FAILED ? 1u : 0u;
        if (nvm->step == HAL_NVM_BUSY || nvm->bad_heads == NVM_FIRST_AT / NVM_HEAD_WORDS) {
            return false;
        }
        nvm->step = HAL_NVM_BUSY;
    }
    nvm->done += NVM_HEAD_WORDS;
    return nvm->done == NVM_FIRST_AT;
}

static void mend_half(hal_nvm_t *nvm) {
    if (put_number(nvm, nvm->number)) {
        const uint32_t other = number_of(nvm, 1u - nvm->half);
        const bool is_older = other != 0u && is_after(nvm->number, other);
        begin_heads(nvm, NVM_MEND_OTHER, 1u - nvm->half);
        nvm->phase = is_older ? NVM_MEND_LAST : NVM_MEND_OTHER;
    }
}

// What has no CRC any more does not count, also where a bit of it cannot be cleared.
static bool clear(hal_nvm_t *nvm, uint32_t at) {
    static const head_t zeros = {0};
    const bool is_over = program(nvm, at, zeros, NVM_HEAD_WORDS) || nvm->step == HAL_NVM_FAILED;
    nvm->step = HAL_NVM_BUSY;
    return is_over;
}

static void mend_other(hal_nvm_t *nvm) {
    if (clear(nvm, nvm->done)) {
        nvm->done += NVM_HEAD_WORDS;
        nvm->phase = nvm->done < NVM_FIRST_AT ? NVM_MEND_OTHER : NVM_MEND_LAST;
    }
}

// The CRC of a whole entry had been programmed before the word that may be weak.
static bool mend_tail(hal_nvm_t *nvm, uint32_t at) {
    uint32_t tail[TAIL_WORDS];
    if (!nvm->is_last_whole) {
        return clear(nvm, at);
    }
    (void)read_log(nvm, at, tail, TAIL_WORDS);
    tail[TAIL_WORDS - 1u] = NVM_WHOLE;
    return put(nvm, at, tail, TAIL_WORDS);
}

static void mend_last(hal_nvm_t *nvm) {
    nvm->to = nvm->half;
    if (nvm->last_at == 0u || mend_tail(nvm, nvm->last_tail_at)) {
        nvm->is_mended = true;
        choose_place(nvm);
    }
}

static void erase(hal_nvm_t *nvm) {
    const hal_nvm_progress_t step =
        hal_nvm_memory_erase(nvm->memory, nvm->to * nvm->half_words + nvm->done);
    if (step != HAL_NVM_DONE) {
        nvm->step = step;
        return;
    }
    nvm->done += hal_nvm_memory_block_words(nvm->memory);
    if (nvm->done >= nvm->half_words) {
        nvm->phase = NVM_COPY;
        nvm->done = 0;
    }
}

static uint32_t copied_words(const hal_nvm_t *nvm, uint32_t record) {
    const bool is_kept = record != nvm->writing && nvm->record[record].at != 0u;
    return is_kept ? entry_words(nvm->record[record].count) : 0u;
}

// A head without a tail is an entry that is not whole: doubt stays until the record is written.
static uint32_t doubt_words(const hal_nvm_t *nvm, uint32_t record) {
    return record != nvm->writing && nvm->record[record].is_doubted ? entry_words(0) : 0u;
}

// A slice of the record that is being copied.
static void copy(hal_nvm_t *nvm) {
    uint32_t part[HAL_NVM_SLICE_WORDS];
    const uint32_t record = nvm->copying;
    const uint32_t size = copied_words(nvm, record);
    const uint32_t all = size + doubt_words(nvm, record);
    const bool is_doubt = nvm->done == size;
    const uint32_t count = is_doubt ? NVM_HEAD_WORDS : least(size - nvm->done, HAL_NVM_SLICE_WORDS);
    if (nvm->done >= all) {
        nvm->place += all;
        nvm->done = 0;
        nvm->copying++;
        nvm->phase = nvm->copying == HAL_NVM_RECORDS ? NVM_ENTRY_HEAD : NVM_COPY;
        return;
    }
    if (is_doubt) {
        make_head(part, NVM_ENTRY + record, 0, nvm->record[record].writes);
    } else if (!read_log(nvm, nvm->record[record].at + nvm->done, part, count)) {
        nvm->step = HAL_NVM_FAILED;
        return;
    }
    if (put(nvm, nvm->place + nvm->done, part, count)) {
        nvm->done = is_doubt ? all : nvm->done + count;
    }
}

static void put_head(hal_nvm_t *nvm) {
    if (put(nvm, nvm->place, nvm->head, NVM_HEAD_WORDS)) {
        nvm->phase = nvm->head[NVM_HEAD_COUNT] == 0u ? NVM_ENTRY_TAIL : NVM_ENTRY_WORDS;
        nvm->done = 0;
    }
}

static void put_words(hal_nvm_t *nvm) {
    const uint32_t left = nvm->head[NVM_HEAD_COUNT] - nvm->done;
    const uint32_t count = least(left, HAL_NVM_SLICE_WORDS);
    const uint32_t *const words = &nvm->words[nvm->done];
    if (put(nvm, nvm->place + NVM_HEAD_WORDS + nvm->done, words, count)) {
        nvm->crc = crc32_continue(nvm->crc, words, count);
        nvm->done += count;
        nvm->phase = count == left ? NVM_ENTRY_TAIL : NVM_ENTRY_WORDS;
    }
}

// The entry counts.
static void finish(hal_nvm_t *nvm) {
    take_entry(nvm, nvm->place, nvm->head, true);
    nvm->step = HAL_NVM_DONE;
}

static void put_tail(hal_nvm_t *nvm) {
    const uint32_t tail[TAIL_WORDS] = {nvm->crc, NVM_WHOLE};
    if (!put(nvm, nvm->place + tail_in(nvm->head[NVM_HEAD_COUNT]), tail, TAIL_WORDS)) {
        return;
    }
    if (nvm->to == nvm->half) {
        finish(nvm);
    } else {
        begin_heads(nvm, NVM_NUMBER, nvm->to);
    }
}

// All records are in the other half now, in their order.
static void change_half(hal_nvm_t *nvm) {
    const uint32_t next = nvm->number == UINT32_MAX ? 1u : nvm->number + 1u;
    if (!put_number(nvm, next)) {
        return;
    }
    uint32_t at = NVM_FIRST_AT;
    for (uint32_t i = 0; i < HAL_NVM_RECORDS; i++) {
        const uint32_t size = copied_words(nvm, i);
        const uint32_t doubt = doubt_words(nvm, i);
        nvm->record[i].at = size != 0u ? at : 0u;
        at += size + doubt;
    }
    nvm->half = nvm->to;
    nvm->number = next;
    nvm->is_mended = true;
    nvm->end = 0;
    finish(nvm);
}

static void advance(hal_nvm_t *nvm) {
    switch (nvm->phase) {
    case NVM_MEND_HALF:
        mend_half(nvm);
        break;
    case NVM_MEND_OTHER:
        mend_other(nvm);
        break;
    case NVM_MEND_LAST:
        mend_last(nvm);
        break;
    case NVM_ERASE:
        erase(nvm);
        break;
    case NVM_COPY:
        copy(nvm);
        break;
    case NVM_ENTRY_HEAD:
        put_head(nvm);
        break;
    case NVM_ENTRY_WORDS:
        put_words(nvm);
        break;
    case NVM_ENTRY_TAIL:
        put_tail(nvm);
        break;
    case NVM_NUMBER:
        change_half(nvm);
        break;
    case NVM_REST:
    default:
        nvm->step = HAL_NVM_IDLE;
        break;
    }
}

// What has failed counts as cut off; the next write goes behind it.
static void give_up(hal_nvm_t *nvm) {
    if (nvm->phase >= NVM_ENTRY_HEAD && nvm->to == nvm->half) {
        const bool was_doubted = nvm->record[nvm->writing].is_doubted;
        take_entry(nvm, nvm->place, nvm->head, false);
        nvm->record[nvm->writing].is_doubted = was_doubted;
        nvm->end += NVM_HEAD_WORDS;
    }
    nvm->is_mended = false;
}

hal_nvm_progress_t hal_nvm_work(hal_nvm_t *nvm) {
    nvm->step = HAL_NVM_BUSY;
    advance(nvm);
    if (nvm->step == HAL_NVM_FAILED) {
        give_up(nvm);
    }
    if (nvm->step != HAL_NVM_BUSY) {
        nvm->phase = NVM_REST;
    }
    return nvm->step;
}

uint32_t hal_nvm_writes(const hal_nvm_t *nvm, uint32_t record) {
    return record < HAL_NVM_RECORDS ? nvm->record[record].writes : 0u;
}

uint32_t hal_nvm_erases(const hal_nvm_t *nvm) {
    return nvm->number;
}
