// libFuzzer: tables of fuzzy systems that were damaged by somebody who knows how to make the
// checksum right again. A table that fuzzy_system_check() accepts is safe at any inputs: nothing is
// undefined (the sanitizers watch), nothing is read beyond its words, every output is a default or
// in its range.
//
// The input: number of a good table, then changes of single words; or, with number 255, the words
// themselves behind a good header.
#include "fuzzy_system_forms.h"

#include "crc32.h"
#include "fuzz_words.h"
#include "system_cases.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

enum { RAW = 255, POINTS = 6, MOST_WORK = 200000 };

static void make_crc_right(copy_t copy) {
    if (copy.count >= FUZZY_HEADER_WORDS) {
        copy.words[0] = FUZZY_SYSTEM_MAGIC;
        copy.words[2] = copy.count;
        copy.words[1] = crc32_words(copy.words + 2, copy.count - 2u);
    }
}

static void check_output(const fuzzy_system_output_t *output, bool is_default, int32_t value) {
    if (is_default) {
        REQUIRE(value == output->value_default);
    } else if (fuzzy_has_sets(output) || output->span != 0) {
        const bool is_moved = !fuzzy_has_sets(output) && output->offset != 0;
        REQUIRE(is_moved || value >= output->origin);
        REQUIRE(is_moved || (int64_t)value <= (int64_t)output->origin + output->span);
    }
}

static void evaluate(const fuzzy_system_t *table, const int32_t *point) {
    // Exactly as many as the table has, for the sanitizer.
    int32_t *input = malloc(table->inputs * sizeof(int32_t));
    int32_t *output = malloc(table->outputs * sizeof(int32_t));
    REQUIRE(input != NULL && output != NULL);
    memcpy(input, point, table->inputs * sizeof(int32_t));
    const uint32_t is_default = fuzzy_system_evaluate(table, input, output);
    REQUIRE(is_default >> table->outputs == 0);
    for (uint32_t i = 0; i < table->outputs; i++) {
        check_output(fuzzy_system_output(table, i), (is_default >> i & 1u) != 0, output[i]);
    }
    free(input);
    free(output);
}

// Places x what is done at each: a slow table is no defect, and tells no more than a quick one.
static uint32_t work_of(const fuzzy_system_t *table) {
    uint32_t work = 0;
    for (uint32_t i = 0; i < table->outputs; i++) {
        const fuzzy_system_output_t *output = fuzzy_system_output(table, i);
        work += fuzzy_has_sets(output) ? output->places * (output->terms + table->rules) : 0;
    }
    return work;
}

static void evaluate_everywhere(const fuzzy_system_t *table) {
    const fuzzy_system_input_t *input = fuzzy_system_at(table, table->inputs_offset);
    uint32_t state = table->crc;
    for (uint32_t k = 0; k < POINTS; k++) {
        int32_t point[FUZZY_SYSTEM_MAX_INPUTS];
        for (uint32_t i = 0; i < table->inputs; i++) {
            const uint64_t span = (uint64_t)((int64_t)input[i].most - input[i].least) + 1u;
            point[i] = k == 0   ? INT32_MIN
                       : k == 1 ? INT32_MAX
                                : (int32_t)(input[i].least + (int64_t)(random_u32(&state) % span));
        }
        evaluate(table, point);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    bytes_t input = {bytes, count};
    const uint32_t which = take(&input, 1);
    const system_case_t *one = &system_cases[which % SYSTEM_CASES];
    copy_t copy = which == RAW ? raw_words(&input) : damaged_words(&input, one->words, one->count);
    make_crc_right(copy);
    const fuzzy_system_t *table = (const fuzzy_system_t *)(const void *)copy.words;
    if (fuzzy_system_check(table, copy.count) == FUZZY_TABLE_OK && work_of(table) <= MOST_WORK) {
        evaluate_everywhere(table);
    }
    free(copy.words);
    return 0;
}
