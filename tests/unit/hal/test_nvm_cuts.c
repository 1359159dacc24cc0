// The power goes at every operation of a save, which is a word programmed or a block erased, in
// each of the ways that tear it; and again at the first operations of the next one. Whatever is
// left, each start finds the old record or the new one, and the others as they were; the next save
// ends, and from then on each start finds that one.
//
// Ends with the numbers that `./tools/benchmark board --part flash` reports.
#include "nvm_rig.h"
#include "unity.h"

#define SUBJECT 1u
#define SMALL 5u // finds room where the subject does not
#define OLD 70u
#define NEW 71u
#define LATER 72u
#ifdef QUIESCE_TARGET_IMAGE
#define STRIDE 11u // the emulator is slow; the host's build has all of them
#else
#define STRIDE 1u
#endif
#define STARTS 2u // weak bits read otherwise in each

// Of the other records, by number; 0: never written. A table, and what changes often.
static const uint32_t other_counts[HAL_NVM_RECORDS] = {90, 0, 150, 0, 20, 8};

static nvm_rig_t rig;
static nvm_rig_t before;
static uint32_t small_key; ///< of the record SMALL
static uint32_t cuts;
static uint32_t lost;

void setUp(void) {}

void tearDown(void) {}

static uint32_t key_of(uint32_t record) {
    return record == SMALL ? small_key : record;
}

static bool are_others_kept(void) {
    hal_nvm_found_t found;
    for (uint32_t i = 0; i < HAL_NVM_RECORDS; i++) {
        if (other_counts[i] != 0u && !rig_has(&rig, i, other_counts[i], key_of(i), &found)) {
            return false;
        }
    }
    return true;
}

static bool is_old_or_new(uint32_t count, bool has_old) {
    hal_nvm_found_t found;
    if (rig_has(&rig, SUBJECT, count, NEW, &found)) {
        return true;
    }
    if (has_old) {
        return rig_has(&rig, SUBJECT, count, OLD, &found);
    }
    // There is none yet; what was begun is told.
    (void)rig_has(&rig, SUBJECT, count, OLD, &found);
    return found == HAL_NVM_NONE || found == HAL_NVM_LOST;
}

static bool is_kept(uint32_t count, uint32_t key) {
    hal_nvm_found_t found;
    return rig_has(&rig, SUBJECT, count, key, &found) && found == HAL_NVM_KEPT;
}

// Whether a few starts, which read weak bits otherwise, all find that.
static bool starts_well(uint32_t count, bool has_old) {
    bool is_good = true;
    for (uint32_t i = 0; i < STARTS; i++) {
        rig_start(&rig);
        is_good = is_good && is_old_or_new(count, has_old) && are_others_kept();
    }
    return is_good;
}

static bool cut_again(uint32_t count, bool has_old, uint32_t after) {
    flash_cut_after(&rig.memory, after, FLASH_MIXED);
    (void)rig_try(&rig, SUBJECT, count, NEW);
    return starts_well(count, has_old);
}

static bool save_small(uint32_t count, bool has_old) {
    small_key++;
    return rig_try(&rig, SMALL, other_counts[SMALL], small_key) == HAL_NVM_DONE &&
           starts_well(count, has_old);
}

static bool save_later(uint32_t count) {
    bool is_good = rig_try(&rig, SUBJECT, count, LATER) == HAL_NVM_DONE;
    for (uint32_t i = 0; i < STARTS; i++) {
        rig_start(&rig);
        is_good = is_good && is_kept(count, LATER) && are_others_kept();
    }
    return is_good;
}

// Returns whether nothing was lost.
static bool survives(uint32_t count, bool has_old, uint32_t again_after) {
    small_key = SMALL;
    return starts_well(count, has_old) &&
           (again_after == FLASH_NEVER || cut_again(count, has_old, again_after)) &&
           save_small(count, has_old) && save_later(count);
}

static uint32_t operations_of_save(uint32_t count) {
    rig = before;
    rig_write(&rig, SUBJECT, count, NEW);
    return rig.memory.operations - before.memory.operations;
}

// After a start, or within the run that made the record before. kinds: of tearing, in turn where
// fewer than all of them.
static void cut_all(uint32_t count, bool has_old, bool is_started, uint32_t kinds) {
    static const uint32_t again[] = {FLASH_NEVER, 0, 3, 8, 13, 18, 25};
    if (is_started) {
        rig_start(&rig);
    }
    before = rig;
    const uint32_t operations = operations_of_save(count);
    for (uint32_t i = 0; i < operations; i += STRIDE) {
        for (uint32_t kind = 0; kind < kinds; kind++) {
            const uint32_t torn = (i + kind) % FLASH_TORN;
            rig = before;
            rig.memory.seed = 1u + i * FLASH_TORN + torn;
            flash_cut_after(&rig.memory, i, (flash_torn_t)torn);
            (void)rig_try(&rig, SUBJECT, count, NEW);
            TEST_ASSERT_TRUE(rig.memory.is_off);
            cuts++;
            lost += survives(count, has_old, again[(i + torn) % 7u]) ? 0u : 1u;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, lost);
}

static void make_records(uint32_t block_words) {
    small_key = SMALL;
    rig_make(&rig, block_words, 0);
    for (uint32_t i = 0; i < HAL_NVM_RECORDS; i++) {
        if (other_counts[i] > 0u) {
            rig_write(&rig, i, other_counts[i], key_of(i));
        }
    }
}

// So that a record of count words finds no room: one more that changes often, at the end.
static void fill_half(uint32_t count) {
    const uint32_t last = other_counts[4] + NVM_ENTRY_EXTRA_WORDS;
    rig.nvm.end = rig.nvm.half_words - last - count;
    rig_write(&rig, 4, other_counts[4], 4);
}

static void test_first_write_of_all(void) {
    static const uint32_t contents[] = {0, UINT32_MAX, 0x5A5A5A5Au};
    for (uint32_t i = 0; i < 3u; i++) {
        rig_make(&rig, 3072, contents[i]);
        before = rig;
        const uint32_t operations = operations_of_save(40);
        for (uint32_t at = 0; at < operations; at += STRIDE) {
            for (uint32_t torn = 0; torn < FLASH_TORN; torn++) {
                rig = before;
                flash_cut_after(&rig.memory, at, (flash_torn_t)torn);
                (void)rig_try(&rig, SUBJECT, 40, NEW);
                cuts++;
                for (uint32_t start = 0; start < STARTS; start++) {
                    rig_start(&rig);
                    lost += is_old_or_new(40, false) ? 0u : 1u;
                }
                rig_write(&rig, SUBJECT, 40, LATER);
                rig_start(&rig);
                lost += is_kept(40, LATER) ? 0u : 1u;
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, lost);
}

static void test_record_that_was_never_written(void) {
    make_records(1024);
    cut_all(41, false, true, FLASH_TORN);
}

static void test_record_that_is_written_again(void) {
    for (uint32_t started = 0; started < 2u; started++) {
        make_records(1024);
        rig_write(&rig, SUBJECT, 40, OLD);
        cut_all(40, true, started == 1u, FLASH_TORN);
    }
}

// Records are copied to the other half, which is erased before.
static void test_write_that_changes_halves(void) {
    for (uint32_t started = 0; started < 2u; started++) {
        make_records(3072);
        rig_write(&rig, SUBJECT, 40, OLD);
        fill_half(40);
        cut_all(40, true, started == 1u, FLASH_TORN);
    }
}

// The other half has been in use before.
static void test_write_that_changes_halves_back(void) {
    make_records(3072);
    rig_write(&rig, SUBJECT, 40, OLD);
    fill_half(40);
    rig_write(&rig, SMALL, other_counts[SMALL], small_key);
    rig_write(&rig, 4, other_counts[4], 4);
    TEST_ASSERT_EQUAL_UINT32(2, hal_nvm_erases(&rig.nvm));
    fill_half(40);
    cut_all(40, true, true, FLASH_TORN);
}

static void test_longest_record(void) {
    make_records(3072);
    rig_write(&rig, SUBJECT, HAL_NVM_MAX_WORDS, OLD);
    cut_all(HAL_NVM_MAX_WORDS, true, true, 1);
}

// One cut after the other, each save of another length, so that halves change on the way.
static void test_many_cuts_in_a_row(void) {
    make_records(1024);
    rig_write(&rig, SUBJECT, 40, OLD);
    fill_half(2000);
    for (uint32_t i = 0; i < 1000u; i++) {
        const uint32_t longest = i % 3u == 0u ? 700u : 61u; // halves change, or do not
        flash_cut_after(&rig.memory, i * 7919u % longest, (flash_torn_t)(i % FLASH_TORN));
        (void)rig_try(&rig, SUBJECT, 40, NEW);
        cuts++;
        rig_start(&rig);
        lost += is_old_or_new(40, true) && are_others_kept() ? 0u : 1u;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(1, hal_nvm_erases(&rig.nvm));
    rig_write(&rig, SUBJECT, 40, LATER);
    rig_start(&rig);
    TEST_ASSERT_TRUE(is_kept(40, LATER));
    TEST_ASSERT_EQUAL_UINT32(0, lost);
}

static void tell(const char *what, uint32_t number) {
    UnityPrint(what);
    UnityPrintNumberUnsigned(number);
    UNITY_PRINT_EOL();
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_first_write_of_all);
    RUN_TEST(test_record_that_was_never_written);
    RUN_TEST(test_record_that_is_written_again);
    RUN_TEST(test_write_that_changes_halves);
    RUN_TEST(test_write_that_changes_halves_back);
    RUN_TEST(test_longest_record);
    RUN_TEST(test_many_cuts_in_a_row);
    tell("flash_cuts ", cuts);
    tell("flash_lost ", lost);
    return UNITY_END();
}
