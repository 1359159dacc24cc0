// libFuzzer: tables of laws and trackers, damaged by somebody who knows how to make the checksum
// right again, on any picture. A table that its check accepts is safe: nothing is undefined (the
// sanitizers watch), nothing is read beyond its words, no current where the damper would have to
// give power, none beyond what parameters allow.
//
// The input: law, tracker, seed of the pictures, then changes of single words of the law's table or
// of the map; or, with a law above 127, the words of its table themselves behind a good magic.
#include "fuzz_bytes.h"
#include "law_trial.h"
#include "law_words.h"
#include "table.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

enum { RAW = 128, OF_MAP = 128, TICKS = 64, CHANGE_BYTES = 6 };

typedef struct {
    uint32_t *words; // as long as the table, so that the sanitizer sees every read beyond it
    uint32_t count;
} copy_t;

static copy_t new_copy(const uint32_t *from, uint32_t count) {
    const copy_t copy = {malloc(count * sizeof(uint32_t)), count};
    REQUIRE(copy.words != NULL);
    if (from != NULL) {
        memcpy(copy.words, from, count * sizeof(uint32_t));
    }
    return copy;
}

static copy_t raw_table(bytes_t *bytes, uint32_t magic) {
    const uint32_t given = (uint32_t)(bytes->left / 4u);
    const uint32_t own = given > 0 && given < QUIESCE_TABLE_WORDS ? given : 1;
    const uint32_t count = TABLE_HEAD_WORDS + own;
    copy_t copy = new_copy(NULL, count);
    copy.words[TABLE_MAGIC] = magic;
    for (uint32_t i = TABLE_HEAD_WORDS; i < count; i++) {
        copy.words[i] = take(bytes, 4);
    }
    return copy;
}

// One from here, or the one that ships; no words: none.
static copy_t good_table(const table_kind_t *kind) {
    const law_words_t good = law_words_of(kind->magic);
    if (good.words != NULL) {
        return new_copy(good.words, good.count);
    }
    return kind->shipped != NULL ? new_copy(kind->shipped, kind->shipped[TABLE_WORDS])
                                 : (copy_t){NULL, 0};
}

static void damage(bytes_t *bytes, copy_t table, copy_t map) {
    while (bytes->left >= CHANGE_BYTES) {
        const uint32_t place = take(bytes, 2);
        const uint32_t value = take(bytes, 4);
        const copy_t copy = (place & OF_MAP << 8) != 0 || table.count == 0 ? map : table;
        copy.words[TABLE_HEAD_WORDS +
                   place % QUIESCE_TABLE_WORDS % (copy.count - TABLE_HEAD_WORDS)] ^= value;
    }
}

static void run(law_trial_t *trial) {
    for (uint32_t i = 0; i < TICKS; i++) {
        law_trial_look(trial);
        law_trial_step(trial);
        law_trial_guard(trial);
        REQUIRE(law_trial_breaks(trial) == 0);
    }
}

static int32_t number_of_laws(void) {
    int32_t count = 0;
    while (law_find(count) != NULL) {
        count++;
    }
    return count;
}

static int32_t number_of_trackers(void) {
    int32_t count = 0;
    while (track_find(count) != NULL) {
        count++;
    }
    return count;
}

static copy_t table_of(bytes_t *bytes, const table_kind_t *kind, bool is_raw) {
    if (kind == NULL) {
        return (copy_t){NULL, 0};
    }
    return is_raw ? raw_table(bytes, kind->magic) : good_table(kind);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t count) {
    static law_trial_t trial;
    bytes_t bytes = {data, count};
    quiesce_params_t params;
    quiesce_params_default(&params);
    const uint32_t first = take(&bytes, 1);
    params.law = (int32_t)(first % RAW) % number_of_laws();
    params.tracker = (int32_t)take(&bytes, 1) % number_of_trackers();
    const uint32_t seed = take(&bytes, 2);
    copy_t table = table_of(&bytes, law_find(params.law)->kind, first >= RAW);
    copy_t map = new_copy(map_of_damper.words, map_of_damper.count);
    damage(&bytes, table, map);
    if (table.count > 0) {
        law_trial_seal(table.words, table.count);
    }
    law_trial_seal(map.words, map.count);
    if (law_trial_start(&trial, &params, table.words, table.count, map.words, map.count, seed)) {
        run(&trial);
    }
    free(table.words);
    free(map.words);
    return 0;
}
