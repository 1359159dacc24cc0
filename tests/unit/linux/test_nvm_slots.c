#include "nvm_slots.h"
#include "one_line.h"
#include "scratch.h"
#include "unity.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static linux_error_t error;
static nvm_slots_t slots;

void setUp(void) {
    error.text[0] = '\0';
    slots = (nvm_slots_t){.fd = -1};
    scratch_make();
}

void tearDown(void) {
    nvm_slots_close(&slots);
    scratch_remove();
}

static void open_slots(uint32_t value) {
    nvm_slots_close(&slots);
    TEST_ASSERT_TRUE_MESSAGE(
        nvm_slots_open(&slots, scratch_path("slots"), "test", &value, sizeof value, &error),
        error.text);
}

static void assert_value(uint32_t expected) {
    uint32_t value = ~expected;
    TEST_ASSERT_EQUAL_MESSAGE(
        NVM_OK, nvm_slots_read(scratch_path("slots"), "test", &value, sizeof value, &error),
        error.text);
    TEST_ASSERT_EQUAL_HEX32(expected, value);
}

static void test_newest_of_many_writes_comes_back(void) {
    open_slots(7);
    assert_value(7);
    for (uint32_t i = 0; i < 20u; i++) {
        TEST_ASSERT_TRUE(nvm_slots_write(&slots, &i));
        assert_value(i);
        if (i % 3u == 0u) {
            open_slots(99); // what is there stays
            assert_value(i);
        }
    }
    TEST_ASSERT_FALSE(scratch_has("slots.make"));
}

static void test_sequence_goes_round(void) {
    uint32_t value = 1;
    open_slots(0);
    slots.sequence = UINT32_MAX - 1u;
    for (; value < 6u; value++) {
        TEST_ASSERT_TRUE(nvm_slots_write(&slots, &value));
    }
    assert_value(5);
}

static void test_every_flipped_bit_of_either_slot_is_damage(void) {
    static uint8_t whole[8192];
    uint32_t value = 5;
    open_slots(4);
    TEST_ASSERT_TRUE(nvm_slots_write(&slots, &value));
    TEST_ASSERT_EQUAL(8192, pread(slots.fd, whole, sizeof whole, 0));
    for (size_t bit = 0; bit < 2u * 8u * 56u; bit++) {
        const size_t at = bit / 8u % 56u + (bit >= 8u * 56u ? 4096u : 0u);
        whole[at] ^= (uint8_t)(1u << bit % 8u);
        scratch_write_bytes("slots", whole, sizeof whole);
        TEST_ASSERT_EQUAL(NVM_DAMAGED, nvm_slots_read(scratch_path("slots"), "test", &value,
                                                      sizeof value, &error));
        whole[at] ^= (uint8_t)(1u << bit % 8u);
    }
    for (size_t cut = 0; cut < sizeof whole; cut += 511u) {
        scratch_write_bytes("slots", whole, cut);
        TEST_ASSERT_EQUAL(NVM_DAMAGED, nvm_slots_read(scratch_path("slots"), "test", &value,
                                                      sizeof value, &error));
    }
    assert_one_line(&error, "damaged");
    open_slots(9); // takes its place
    assert_value(9);
}

static void test_what_cannot_be_made_is_one_line(void) {
    const uint32_t value = 0;
    nvm_slots_t none;
    TEST_ASSERT_FALSE(
        nvm_slots_open(&none, scratch_path("no/folder"), "test", &value, sizeof value, &error));
    assert_one_line(&error, "No such file");
    scratch_folder("slots.make");
    TEST_ASSERT_FALSE(
        nvm_slots_open(&none, scratch_path("slots"), "test", &value, sizeof value, &error));
    assert_one_line(&error, "cannot reserve its room");
    uint32_t read;
    TEST_ASSERT_EQUAL(NVM_MISSING,
                      nvm_slots_read(scratch_path("slots"), "test", &read, sizeof read, &error));
    TEST_ASSERT_EQUAL_INT(0, mkfifo(scratch_path("fifo"), 0600));
    TEST_ASSERT_EQUAL(NVM_DAMAGED, nvm_slots_read(scratch_path("fifo"), "test", &read, sizeof read,
                                                  &error)); // without waiting
}

static void test_removed_file_is_noticed(void) {
    open_slots(1);
    TEST_ASSERT_TRUE(nvm_slots_are_at(&slots, scratch_path("slots")));
    TEST_ASSERT_EQUAL_INT(0, unlink(scratch_path("slots")));
    TEST_ASSERT_FALSE(nvm_slots_are_at(&slots, scratch_path("slots")));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_newest_of_many_writes_comes_back);
    RUN_TEST(test_sequence_goes_round);
    RUN_TEST(test_every_flipped_bit_of_either_slot_is_damage);
    RUN_TEST(test_what_cannot_be_made_is_one_line);
    RUN_TEST(test_removed_file_is_noticed);
    return UNITY_END();
}
