// An update at each of whose operations the power goes, in each of the ways that tear it, and again
// at the first operations of the start after it. Whatever is left, each start finds an image that
// is whole: the old one, or the new one, which runs unconfirmed once at the most; from the second
// start on always the same one; and the next update ends.
//
// Ends with the numbers that `./tools/benchmark board --part flash` reports.
#include "flash_model.h"
#include "slots.h"
#include "unity.h"
#include "word_crc.h"

#define IMAGE_WORDS 40u
#define BLOCK_WORDS (IMAGE_WORDS + SLOT_MARK_WORDS)
#define OLD 1u
#define NEW 2u
#define LATER 3u
#define STARTS 4u
#define MOST_CALLS 1000u

typedef struct {
    hal_nvm_memory_t memory;
    uint32_t trials; ///< starts of NEW before it was confirmed
} rig_t;

static rig_t rig;
static rig_t before;
static slots_t slots;
static uint32_t cuts;
static uint32_t lost;

void setUp(void) {
    slots_open(&slots, &rig.memory);
}

void tearDown(void) {}

// ---- images -------------------------------------------------------------------------------------

static void make_image(uint32_t words[IMAGE_WORDS], uint32_t version) {
    uint32_t crc = WORD_CRC_START;
    words[0] = version;
    for (uint32_t i = 1; i < IMAGE_WORDS - 1u; i++) {
        words[i] = version * 2654435761u + i * 40503u;
    }
    for (uint32_t i = 0; i < IMAGE_WORDS - 1u; i++) {
        crc = word_crc_append(crc, words[i]);
    }
    words[IMAGE_WORDS - 1u] = crc;
}

// Its version, 0 where none is whole.
static uint32_t version_in(uint32_t slot) {
    uint32_t words[IMAGE_WORDS];
    uint32_t crc = WORD_CRC_START;
    TEST_ASSERT_TRUE(hal_nvm_memory_read(&rig.memory, slot * BLOCK_WORDS, words, IMAGE_WORDS));
    for (uint32_t i = 0; i < IMAGE_WORDS - 1u; i++) {
        crc = word_crc_append(crc, words[i]);
    }
    return crc == words[IMAGE_WORDS - 1u] ? words[0] : 0u;
}

static void find_whole(bool is_whole[SLOTS]) {
    for (uint32_t i = 0; i < SLOTS; i++) {
        is_whole[i] = version_in(i) != 0u;
    }
}

static slot_state_t state_of(uint32_t slot) {
    return slots_state(&slots, slot, version_in(slot) != 0u);
}

// As a debugger does: the slot is erased before.
static void flash_by_hand(uint32_t slot, uint32_t version) {
    for (uint32_t i = 0; i < BLOCK_WORDS; i++) {
        rig.memory.words[slot * BLOCK_WORDS + i] = UINT32_MAX;
        rig.memory.weak[slot * BLOCK_WORDS + i] = 0;
    }
    make_image(&rig.memory.words[slot * BLOCK_WORDS], version);
}

static void make_rig(uint32_t version) {
    flash_make(&rig.memory, SLOTS * BLOCK_WORDS, BLOCK_WORDS, 0x5A5A5A5Au);
    rig.trials = 0;
    flash_by_hand(0, version);
}

// ---- what the boot code and the image do --------------------------------------------------------

// Returns the slot that runs, which has settled.
static uint32_t start(void) {
    bool is_whole[SLOTS];
    find_whole(is_whole);
    const uint32_t slot = slots_start(&slots, is_whole);
    if (slot != SLOT_NONE && !rig.memory.is_off) {
        find_whole(is_whole);
        (void)slots_settle(&slots, slot, is_whole);
    }
    return slot;
}

static uint32_t power_up(void) {
    flash_power_up(&rig.memory);
    slots_open(&slots, &rig.memory);
    return start();
}

static bool prepare(uint32_t slot) {
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && progress == HAL_NVM_BUSY; i++) {
        progress = slots_prepare(&slots, slot);
    }
    return progress == HAL_NVM_DONE;
}

static bool write_words(uint32_t slot, uint32_t at, const uint32_t *words, uint32_t count) {
    hal_nvm_progress_t progress = HAL_NVM_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && progress == HAL_NVM_BUSY; i++) {
        progress = slots_write(&slots, slot, at, words, count);
    }
    return progress == HAL_NVM_DONE;
}

static bool write_image(uint32_t slot, uint32_t version) {
    uint32_t words[IMAGE_WORDS];
    bool is_good = true;
    make_image(words, version);
    for (uint32_t at = 0; is_good && at < IMAGE_WORDS; at += HAL_NVM_SLICE_WORDS) {
        const uint32_t left = IMAGE_WORDS - at;
        is_good = write_words(slot, at, &words[at],
                              left < HAL_NVM_SLICE_WORDS ? left : HAL_NVM_SLICE_WORDS);
    }
    return is_good;
}

// Into the slot that does not run, up to where the image restarts.
static bool install(uint32_t running, uint32_t version) {
    const uint32_t slot = 1u - running;
    return prepare(slot) && write_image(slot, version) && version_in(slot) == version &&
           slots_finish(&slots, slot);
}

// All of an update, or what the power allows.
static bool update(uint32_t running, uint32_t version) {
    if (!install(running, version)) {
        return false;
    }
    const uint32_t slot = start();
    if (rig.memory.is_off || slot != 1u - running || version_in(slot) != version) {
        return false;
    }
    rig.trials++;
    return slots_confirm(&slots, slot);
}

// ---- cuts ---------------------------------------------------------------------------------------

// An image that was started on trial does not confirm itself here. Returns its version.
static uint32_t start_after_cut(void) {
    const uint32_t slot = power_up();
    if (slot == SLOT_NONE) {
        return 0;
    }
    if (version_in(slot) == NEW && slots_is_trial(&slots, slot)) {
        rig.trials++;
    }
    return version_in(slot);
}

// The first start may be the trial; all others find one and the same.
static bool starts_well(void) {
    uint32_t versions[STARTS];
    bool is_good = true;
    for (uint32_t i = 0; i < STARTS; i++) {
        versions[i] = start_after_cut();
        is_good = is_good && (versions[i] == OLD || versions[i] == NEW);
        is_good = is_good && (i < 2u || versions[i] == versions[1]);
    }
    return is_good && rig.trials <= 1u;
}

static bool next_update_ends(void) {
    const uint32_t running = power_up();
    return running != SLOT_NONE && update(running, LATER) && power_up() == 1u - running &&
           version_in(1u - running) == LATER && !slots_is_trial(&slots, 1u - running);
}

static bool survives(uint32_t again_after) {
    if (again_after != FLASH_NEVER) {
        flash_power_up(&rig.memory);
        flash_cut_after(&rig.memory, again_after, FLASH_MIXED);
        (void)start(); // the start that is cut, too
    }
    return starts_well() && next_update_ends();
}

static void cut_all(uint32_t running) {
    static const uint32_t again[] = {FLASH_NEVER, 0, 1, 2};
    before = rig;
    TEST_ASSERT_TRUE(update(running, NEW));
    const uint32_t operations = rig.memory.operations - before.memory.operations;
    TEST_ASSERT_GREATER_THAN_UINT32(IMAGE_WORDS, operations);
    for (uint32_t at = 0; at < operations; at++) {
        for (uint32_t torn = 0; torn < FLASH_TORN; torn++) {
            for (uint32_t i = 0; i < 4u; i++) {
                rig = before;
                rig.memory.seed = 1u + (at * FLASH_TORN + torn) * 4u + i;
                flash_cut_after(&rig.memory, at, (flash_torn_t)torn);
                TEST_ASSERT_FALSE(update(running, NEW) && !rig.memory.is_off);
                TEST_ASSERT_TRUE(rig.memory.is_off);
                cuts++;
                lost += survives(again[i]) ? 0u : 1u;
            }
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, lost);
}

static void test_first_update_of_what_a_debugger_has_written(void) {
    make_rig(OLD);
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
    cut_all(0);
}

// The slot that is written was in use before, and the other one is superseded.
static void test_update_of_an_update(void) {
    make_rig(LATER);
    TEST_ASSERT_TRUE(update(power_up(), OLD));
    TEST_ASSERT_EQUAL_UINT32(1, power_up());
    rig.trials = 0;
    cut_all(1);
}

static void test_update_after_one_that_was_gone_back_from(void) {
    make_rig(OLD);
    TEST_ASSERT_TRUE(install(power_up(), LATER));
    TEST_ASSERT_EQUAL_UINT32(1, power_up());
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
    cut_all(0);
}

// ---- without cuts -------------------------------------------------------------------------------

static void test_what_is_not_confirmed_runs_once(void) {
    make_rig(OLD);
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
    TEST_ASSERT_FALSE(slots_is_trial(&slots, 0));
    TEST_ASSERT_TRUE(install(0, NEW));
    TEST_ASSERT_EQUAL_INT(SLOT_TRIAL, state_of(1));
    TEST_ASSERT_EQUAL_UINT32(1, power_up());
    TEST_ASSERT_TRUE(slots_is_trial(&slots, 1));
    TEST_ASSERT_EQUAL_INT(SLOT_GOOD, state_of(0));
    for (uint32_t i = 0; i < STARTS; i++) {
        TEST_ASSERT_EQUAL_UINT32(0, power_up());
        TEST_ASSERT_EQUAL_INT(SLOT_REJECTED, state_of(1));
    }
    TEST_ASSERT_FALSE(slots_confirm(&slots, 1)); // too late
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
}

static void test_what_is_confirmed_stays(void) {
    make_rig(OLD);
    TEST_ASSERT_TRUE(update(power_up(), NEW));
    for (uint32_t i = 0; i < STARTS; i++) {
        TEST_ASSERT_EQUAL_UINT32(1, power_up());
        TEST_ASSERT_EQUAL_INT(SLOT_GOOD, state_of(1));
        TEST_ASSERT_EQUAL_INT(SLOT_SUPERSEDED, state_of(0));
    }
}

static void test_an_update_goes_back_where_its_image_breaks(void) {
    make_rig(OLD);
    TEST_ASSERT_TRUE(update(power_up(), NEW));
    rig.memory.words[BLOCK_WORDS + 7u] ^= 1u;
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
    TEST_ASSERT_EQUAL_INT(SLOT_EMPTY, state_of(1));
}

static void test_what_a_debugger_writes_later_counts(void) {
    make_rig(OLD);
    TEST_ASSERT_TRUE(update(power_up(), NEW));
    TEST_ASSERT_EQUAL_UINT32(1, power_up());
    flash_by_hand(0, OLD);
    for (uint32_t i = 0; i < STARTS; i++) {
        TEST_ASSERT_EQUAL_UINT32(0, power_up());
        TEST_ASSERT_EQUAL_INT(SLOT_SUPERSEDED, state_of(1));
    }
}

static void test_nothing_runs_that_is_not_whole_or_was_rejected(void) {
    make_rig(OLD);
    TEST_ASSERT_TRUE(install(power_up(), NEW));
    rig.memory.words[3] ^= 4u;
    TEST_ASSERT_EQUAL_UINT32(1, power_up());
    TEST_ASSERT_EQUAL_UINT32(SLOT_NONE, power_up());
    rig.memory.words[3] ^= 4u;
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
}

static void test_a_trial_that_cannot_be_marked_is_not_run(void) {
    make_rig(OLD);
    TEST_ASSERT_TRUE(install(power_up(), NEW));
    for (uint32_t i = IMAGE_WORDS; i < BLOCK_WORDS; i++) {
        rig.memory.bad_word = BLOCK_WORDS + i;
        if (state_of(1) != SLOT_TRIAL) {
            continue;
        }
        before = rig;
        TEST_ASSERT_NOT_EQUAL_UINT32(SLOT_NONE, power_up());
        rig = before;
    }
    rig.memory.bad_word = BLOCK_WORDS + IMAGE_WORDS + 8u; // of the mark that it was tried
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
}

static void test_nothing_is_written_outside_of_the_room(void) {
    const uint32_t words[HAL_NVM_SLICE_WORDS] = {0};
    make_rig(OLD);
    TEST_ASSERT_EQUAL_UINT32(IMAGE_WORDS, slots_room(&slots));
    TEST_ASSERT_TRUE(prepare(1));
    before = rig;
    TEST_ASSERT_FALSE(write_words(1, IMAGE_WORDS, words, 4));
    TEST_ASSERT_FALSE(write_words(1, IMAGE_WORDS - 4u, words, 5));
    TEST_ASSERT_FALSE(write_words(1, UINT32_MAX - 3u, words, 8));
    TEST_ASSERT_FALSE(write_words(1, 2, words, 4));
    TEST_ASSERT_EQUAL_MEMORY(before.memory.words, rig.memory.words, sizeof before.memory.words);
    TEST_ASSERT_TRUE(write_words(1, IMAGE_WORDS - 4u, words, 4));
}

static void test_only_what_was_prepared_is_finished(void) {
    make_rig(OLD);
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
    flash_by_hand(1, NEW);
    TEST_ASSERT_FALSE(slots_finish(&slots, 1));
}

static void test_flash_that_refuses_is_told(void) {
    make_rig(OLD);
    rig.memory.bad_word = BLOCK_WORDS + IMAGE_WORDS + 20u; // the mark of what is given up
    TEST_ASSERT_FALSE(prepare(1));
    rig.memory.bad_word = BLOCK_WORDS + IMAGE_WORDS; // that something comes
    TEST_ASSERT_FALSE(prepare(1));
    TEST_ASSERT_EQUAL_UINT32(0, power_up());
}

static void tell(const char *what, uint32_t number) {
    UnityPrint(what);
    UnityPrintNumberUnsigned(number);
    UNITY_PRINT_EOL();
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_first_update_of_what_a_debugger_has_written);
    RUN_TEST(test_update_of_an_update);
    RUN_TEST(test_update_after_one_that_was_gone_back_from);
    RUN_TEST(test_what_is_not_confirmed_runs_once);
    RUN_TEST(test_what_is_confirmed_stays);
    RUN_TEST(test_an_update_goes_back_where_its_image_breaks);
    RUN_TEST(test_what_a_debugger_writes_later_counts);
    RUN_TEST(test_nothing_runs_that_is_not_whole_or_was_rejected);
    RUN_TEST(test_a_trial_that_cannot_be_marked_is_not_run);
    RUN_TEST(test_nothing_is_written_outside_of_the_room);
    RUN_TEST(test_only_what_was_prepared_is_finished);
    RUN_TEST(test_flash_that_refuses_is_told);
    tell("flash_cuts ", cuts);
    tell("flash_lost ", lost);
    return UNITY_END();
}
