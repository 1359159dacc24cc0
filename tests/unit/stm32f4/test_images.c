// An update of an image on fakes of the flash: what a host asks for, what the next start finds, how
// an image on trial confirms itself or goes.
#include "fake_flash.h"
#include "image_info.h"
#include "images.h"
#include "sha256.h"
#include "unity.h"

#include <string.h>

#define BOARD "some_board"
#define IMAGE_BYTES 3000u ///< with its seal
#define INFO_AT 452u
#define MOST_CALLS 20000u

static images_t images;
static images_self_t self;
static uint8_t image[IMAGE_BYTES];

// ---- images -------------------------------------------------------------------------------------

static uint32_t begin_of(uint32_t slot) {
    return nvm_stm32f4_images.block[slot].begin;
}

static void put(uint32_t at, uint32_t word) {
    for (uint32_t i = 0; i < 4u; i++) {
        image[at + i] = (uint8_t)(word >> (8u * i));
    }
}

// Of that version, linked for a slot, into image[].
static void make_image(uint32_t slot, uint32_t version, const char *board) {
    const uint32_t begin = begin_of(slot);
    const uint32_t seal_at = IMAGE_BYTES - SHA256_BYTES;
    const uint32_t words[8] = {IMAGE_INFO_MAGIC, IMAGE_INFO_LAYOUT, version,     9u, begin,
                               begin + seal_at,  begin + 600u,      begin + 700u};
    for (uint32_t i = 0; i < IMAGE_BYTES; i++) {
        image[i] = (uint8_t)(31u * i + 7u * version + (i >> 6));
    }
    for (uint32_t i = 0; i < 8u; i++) {
        put(INFO_AT + 4u * i, words[i]);
    }
    put(600, begin + 620u);
    strcpy((char *)&image[620], board);
    sha256(image, seal_at, &image[seal_at]);
}

static uint32_t *flash_at(uint32_t slot) {
    return &fake_flash[(begin_of(slot) - FAKE_FLASH_BASE) / 4u];
}

// As a debugger does.
static void flash_by_hand(uint32_t slot, uint32_t version) {
    make_image(slot, version, BOARD);
    memset(flash_at(slot), 0xFF, 4u * nvm_stm32f4_images.block_words);
    memcpy(flash_at(slot), image, IMAGE_BYTES);
}

// ---- starts -------------------------------------------------------------------------------------

// What the boot code does; returns the slot.
static uint32_t boot(void) {
    hal_nvm_memory_t memory = {.area = &nvm_stm32f4_images};
    slots_t slots;
    bool is_whole[SLOTS];
    slots_open(&slots, &memory);
    images_look(is_whole, BOARD);
    return slots_start(&slots, is_whole);
}

static void open(uint32_t begin) {
    self = (images_self_t){.begin = begin, .version = 0x010203u, .mark = 77u, .board = BOARD};
    images_open(&images, &self);
    images.memory.may_erase = true; // the board's main gives it
}

// Returns the slot that runs.
static uint32_t start(void) {
    const uint32_t slot = boot();
    TEST_ASSERT_LESS_THAN_UINT32(SLOTS, slot);
    open(begin_of(slot));
    TEST_ASSERT_EQUAL_UINT32(slot, images.running);
    return slot;
}

static void pass(uint32_t ms, bool is_well) {
    for (uint32_t i = 0; i < ms; i++) {
        TEST_ASSERT_EQUAL(IMAGES_NOTHING, images_tick(&images, 1, is_well));
    }
}

void setUp(void) {
    fake_reset(FAKE_F405);
    fake_flash_reset(1, 5);
    fake_use_hook(fake_flash_behave);
    flash_by_hand(0, 1);
}

void tearDown(void) {
    TEST_ASSERT_NULL_MESSAGE(fake_mistake(), fake_mistake());
    fake_flash_assert_at_rest();
}

// ---- what a host asks for -----------------------------------------------------------------------

static const image_store_t *store(void) {
    const image_store_t *const found = images_store(&images);
    TEST_ASSERT_NOT_NULL(found);
    return found;
}

static uint32_t tell(image_info_number_t what) {
    return store()->tell(store()->context, what);
}

static image_store_answer_t prepare(void) {
    image_store_answer_t answer = IMAGE_STORE_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && answer == IMAGE_STORE_BUSY; i++) {
        answer = store()->prepare(store()->context);
    }
    return answer;
}

static image_store_answer_t write_piece(uint32_t at, const uint32_t *words, uint32_t count) {
    image_store_answer_t answer = IMAGE_STORE_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && answer == IMAGE_STORE_BUSY; i++) {
        answer = store()->write(store()->context, at, words, count);
    }
    return answer;
}

static image_store_answer_t finish(void) {
    image_store_answer_t answer = IMAGE_STORE_BUSY;
    for (uint32_t i = 0; i < MOST_CALLS && answer == IMAGE_STORE_BUSY; i++) {
        answer = store()->finish(store()->context);
    }
    return answer;
}

// image[], in pieces of so many words.
static void write_image(uint32_t piece) {
    uint32_t words[IMAGE_BYTES / 4u];
    memcpy(words, image, IMAGE_BYTES);
    for (uint32_t at = 0; at < IMAGE_BYTES / 4u; at += piece) {
        const uint32_t left = IMAGE_BYTES / 4u - at;
        TEST_ASSERT_EQUAL(IMAGE_STORE_DONE,
                          write_piece(at, &words[at], left < piece ? left : piece));
    }
}

static void install(uint32_t version) {
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    make_image(1u - images.running, version, BOARD);
    write_image(256);
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, finish());
}

static void run_trial(void) {
    TEST_ASSERT_TRUE(images.is_trial);
    (void)tell(IMAGE_INFO_VERSION);
    pass(TRIAL_RUN_MS, true);
    TEST_ASSERT_FALSE(images.is_trial);
}

static void test_an_update_is_tried_confirmed_and_stays(void) {
    TEST_ASSERT_EQUAL_UINT32(0, start());
    TEST_ASSERT_FALSE(images.is_trial);
    install(2);
    TEST_ASSERT_EQUAL_UINT32(SLOT_TRIAL, tell(IMAGE_INFO_OTHER));
    TEST_ASSERT_EQUAL_UINT32(1, start());
    TEST_ASSERT_EQUAL_UINT32(SLOT_GOOD, tell(IMAGE_INFO_OTHER));
    run_trial();
    for (uint32_t i = 0; i < 3u; i++) {
        TEST_ASSERT_EQUAL_UINT32(1, start());
        TEST_ASSERT_EQUAL_UINT32(SLOT_SUPERSEDED, tell(IMAGE_INFO_OTHER));
    }
    install(3); // and back into the first one
    TEST_ASSERT_EQUAL_UINT32(0, start());
    run_trial();
    TEST_ASSERT_EQUAL_UINT32(0, start());
}

static void test_it_tells_what_it_is_and_where_the_other_one_goes(void) {
    (void)start();
    TEST_ASSERT_EQUAL_HEX32(0x010203u, tell(IMAGE_INFO_VERSION));
    TEST_ASSERT_EQUAL_UINT32(0, tell(IMAGE_INFO_SLOT));
    TEST_ASSERT_EQUAL_UINT32(77, tell(IMAGE_INFO_MARK));
    TEST_ASSERT_EQUAL_UINT32(0, tell(IMAGE_INFO_IS_TRIAL));
    TEST_ASSERT_EQUAL_UINT32(SLOT_EMPTY, tell(IMAGE_INFO_OTHER));
    TEST_ASSERT_EQUAL_HEX32(0x08020000u, tell(IMAGE_INFO_BEGIN));
    TEST_ASSERT_EQUAL_UINT32(0x1C000u - 128u, tell(IMAGE_INFO_ROOM));
    // zlib.crc32(b"some_board".ljust(32, b"\0"))
    TEST_ASSERT_EQUAL_HEX32(0xE0A34A6Fu, tell(IMAGE_INFO_BOARD));
}

static void test_a_trial_that_nobody_asks_for_ends(void) {
    (void)start();
    install(2);
    TEST_ASSERT_EQUAL_UINT32(1, start());
    pass(TRIAL_MOST_MS - 1u, true);
    TEST_ASSERT_TRUE(images.is_trial);
    TEST_ASSERT_EQUAL(IMAGES_RESTART, images_tick(&images, 1, true));
    TEST_ASSERT_EQUAL_UINT32(0, start());
    TEST_ASSERT_EQUAL_UINT32(SLOT_REJECTED, tell(IMAGE_INFO_OTHER));
}

// A fault that is latched has kept it from restarting; then a host has come.
static void test_a_trial_that_confirms_late_goes_on(void) {
    (void)start();
    install(2);
    TEST_ASSERT_EQUAL_UINT32(1, start());
    pass(TRIAL_MOST_MS - 1u, true);
    TEST_ASSERT_EQUAL(IMAGES_RESTART, images_tick(&images, 1, true));
    (void)tell(IMAGE_INFO_VERSION);
    pass(10, true);
    TEST_ASSERT_FALSE(images.is_trial);
    TEST_ASSERT_EQUAL_UINT32(1, start());
}

static void test_a_trial_after_a_fault_of_the_processor_is_not_confirmed(void) {
    (void)start();
    install(2);
    TEST_ASSERT_EQUAL_UINT32(1, start());
    (void)tell(IMAGE_INFO_VERSION);
    pass(TRIAL_MOST_MS - 1u, false);
    TEST_ASSERT_TRUE(images.is_trial);
    TEST_ASSERT_EQUAL_UINT32(0, start());
}

static void test_a_trial_takes_no_update(void) {
    (void)start();
    install(2);
    TEST_ASSERT_EQUAL_UINT32(1, start());
    TEST_ASSERT_EQUAL(IMAGE_STORE_REFUSED, prepare());
    TEST_ASSERT_EQUAL_UINT32(SLOT_GOOD, tell(IMAGE_INFO_OTHER));
}

static void assert_refused(void) {
    TEST_ASSERT_EQUAL(IMAGE_STORE_REFUSED, finish());
    TEST_ASSERT_EQUAL_UINT32(0, start());
}

static void test_what_is_not_whole_or_not_for_here_is_refused(void) {
    (void)start();
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    assert_refused(); // nothing was written
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    make_image(0, 2, BOARD); // linked for the other place
    write_image(256);
    assert_refused();
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    make_image(1, 2, "other_board");
    write_image(256);
    assert_refused();
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    make_image(1, 2, BOARD);
    image[1500] ^= 1u;
    write_image(256);
    assert_refused();
    install(2);
    TEST_ASSERT_EQUAL_UINT32(1, start());
}

static void test_flash_that_fails_is_told_and_the_old_image_stays(void) {
    (void)start();
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    make_image(1, 2, BOARD);
    fake_flash_state.worn_word = (begin_of(1) - FAKE_FLASH_BASE) / 4u + 33u;
    uint32_t words[64];
    memcpy(words, image, sizeof words);
    TEST_ASSERT_EQUAL(IMAGE_STORE_FAILED, write_piece(0, words, 64));
    fake_flash_state.busy_reads = UINT32_MAX;
    TEST_ASSERT_EQUAL(IMAGE_STORE_BUSY, prepare()); // it takes as long as it takes
    fake_flash_state.left = 1;
    fake_flash_state.busy_reads = 3;
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    TEST_ASSERT_EQUAL_UINT32(0, start());
}

static void test_nothing_is_written_behind_the_room(void) {
    const uint32_t words[4] = {0};
    (void)start();
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
    TEST_ASSERT_EQUAL(IMAGE_STORE_FAILED, write_piece(tell(IMAGE_INFO_ROOM) / 4u, words, 4));
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, write_piece(tell(IMAGE_INFO_ROOM) / 4u - 4u, words, 4));
}

static void test_an_erasure_waits_for_leave(void) {
    (void)start();
    images.memory.may_erase = false;
    TEST_ASSERT_EQUAL(IMAGE_STORE_BUSY, prepare());
    TEST_ASSERT_EQUAL_UINT32(0, fake_flash_state.erased_sectors);
    images.memory.may_erase = true;
    TEST_ASSERT_EQUAL(IMAGE_STORE_DONE, prepare());
}

static void test_a_restart_waits_for_the_reply(void) {
    (void)start();
    store()->start(store()->context);
    pass(RESTART_MS - 1u, true);
    TEST_ASSERT_EQUAL(IMAGES_RESTART, images_tick(&images, 1, true));
}

// As CMake links it for a debugger: there is no boot code.
static void test_an_image_by_itself_has_no_other_place(void) {
    open(0x08000000u);
    TEST_ASSERT_NULL(images_store(&images));
    pass(2u * TRIAL_MOST_MS, true);
    TEST_ASSERT_EQUAL_UINT32(0, fake_all_writes());
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_an_update_is_tried_confirmed_and_stays);
    RUN_TEST(test_it_tells_what_it_is_and_where_the_other_one_goes);
    RUN_TEST(test_a_trial_that_nobody_asks_for_ends);
    RUN_TEST(test_a_trial_that_confirms_late_goes_on);
    RUN_TEST(test_a_trial_after_a_fault_of_the_processor_is_not_confirmed);
    RUN_TEST(test_a_trial_takes_no_update);
    RUN_TEST(test_what_is_not_whole_or_not_for_here_is_refused);
    RUN_TEST(test_flash_that_fails_is_told_and_the_old_image_stays);
    RUN_TEST(test_nothing_is_written_behind_the_room);
    RUN_TEST(test_an_erasure_waits_for_leave);
    RUN_TEST(test_a_restart_waits_for_the_reply);
    RUN_TEST(test_an_image_by_itself_has_no_other_place);
    return UNITY_END();
}
