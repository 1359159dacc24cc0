#include "nvm_file.h"
#include "one_line.h"
#include "scratch.h"
#include "unity.h"

#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define HEADER_BYTES 24u

static linux_error_t error;

void setUp(void) {
    error.text[0] = '\0';
    scratch_make();
}

void tearDown(void) {
    scratch_remove();
}

static nvm_verdict_t read_record(const char *name, void *data, size_t bytes) {
    return nvm_file_read(scratch_path(name), "param", 3, data, bytes, &error);
}

static bool write_record(const char *name, const void *data, size_t bytes) {
    return nvm_file_write(scratch_path(name), "param", 3, data, bytes, &error);
}

static size_t load(const char *name, uint8_t *bytes, size_t room) {
    FILE *const file = fopen(scratch_path(name), "re");
    TEST_ASSERT_NOT_NULL(file);
    const size_t count = fread(bytes, 1, room, file);
    TEST_ASSERT_EQUAL_INT(0, fclose(file));
    return count;
}

static void test_record_of_any_length_comes_back(void) {
    static uint8_t data[NVM_MAX_BYTES];
    static uint8_t back[NVM_MAX_BYTES];
    static const size_t lengths[] = {0, 1, 3, 4, 5, 257, NVM_MAX_BYTES};
    for (size_t i = 0; i < sizeof data; i++) {
        data[i] = (uint8_t)(i * 7u + 1u);
    }
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        memset(back, 0, sizeof back);
        TEST_ASSERT_TRUE_MESSAGE(write_record("record", data, lengths[i]), error.text);
        TEST_ASSERT_EQUAL_MESSAGE(NVM_OK, read_record("record", back, lengths[i]), error.text);
        TEST_ASSERT_EQUAL_INT(0, memcmp(data, back, lengths[i]));
        TEST_ASSERT_FALSE(scratch_has("record.new"));
    }
}

/// Files of other versions of the program stay readable. The checksum is zlib's.
static void test_format_is_as_it_was(void) {
    static const uint8_t file[] = {
        0x4E, 0x56, 0x4D, 0x31, 0x4D, 0xF2, 0x70, 0x09, 0x70, 0x61, 0x72, 0x61, 0x6D, 0x00,
        0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x78, 0x56, 0x34, 0x12,
    };
    uint32_t back = 0;
    scratch_write_bytes("record", file, sizeof file);
    TEST_ASSERT_EQUAL_MESSAGE(NVM_OK, read_record("record", &back, sizeof back), error.text);
    TEST_ASSERT_EQUAL_HEX32(0x12345678, back);
}

static void test_missing_file_is_no_damage(void) {
    uint32_t value = 7;
    TEST_ASSERT_EQUAL(NVM_MISSING, read_record("none", &value, sizeof value));
    TEST_ASSERT_EQUAL(NVM_MISSING, read_record("no/folder", &value, sizeof value));
    TEST_ASSERT_EQUAL_UINT32(7, value);
    assert_one_line(&error, "no such file");
}

static void test_other_kind_version_or_length_is_damage(void) {
    const uint32_t data[2] = {1, 2};
    uint32_t back[3] = {9, 9, 9};
    const char *const path = scratch_path("record");
    TEST_ASSERT_TRUE(write_record("record", data, sizeof data));
    TEST_ASSERT_EQUAL(NVM_DAMAGED, nvm_file_read(path, "adapt", 3, back, 8, &error));
    assert_one_line(&error, "another kind");
    TEST_ASSERT_EQUAL(NVM_DAMAGED, nvm_file_read(path, "param", 4, back, 8, &error));
    assert_one_line(&error, "another version");
    TEST_ASSERT_EQUAL(NVM_DAMAGED, nvm_file_read(path, "param", 3, back, 12, &error));
    assert_one_line(&error, "length");
    TEST_ASSERT_EQUAL(NVM_DAMAGED, nvm_file_read(path, "param", 3, back, 4, &error));
    TEST_ASSERT_EQUAL_UINT32(9, back[0]);
    TEST_ASSERT_EQUAL(NVM_OK, nvm_file_read(path, "param", 3, back, 8, &error));
}

static void test_every_cut_and_every_flipped_bit_is_damage(void) {
    const uint32_t data[3] = {0x12345678, 0, UINT32_MAX};
    uint8_t whole[64];
    uint32_t back[3] = {0};
    TEST_ASSERT_TRUE(write_record("record", data, sizeof data));
    const size_t count = load("record", whole, sizeof whole);
    TEST_ASSERT_EQUAL_size_t(HEADER_BYTES + sizeof data, count);
    for (size_t cut = 0; cut < count; cut++) {
        scratch_write_bytes("cut", whole, cut);
        TEST_ASSERT_EQUAL(NVM_DAMAGED, read_record("cut", back, sizeof back));
    }
    for (size_t bit = 0; bit < 8u * count; bit++) {
        whole[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
        scratch_write_bytes("flipped", whole, count);
        TEST_ASSERT_EQUAL(NVM_DAMAGED, read_record("flipped", back, sizeof back));
        whole[bit / 8u] ^= (uint8_t)(1u << bit % 8u);
    }
    scratch_write_bytes("longer", whole, count + 1u);
    TEST_ASSERT_EQUAL(NVM_DAMAGED, read_record("longer", back, sizeof back));
    scratch_write("text", "this is no record, however long the text is");
    TEST_ASSERT_EQUAL(NVM_DAMAGED, read_record("text", back, sizeof back));
    assert_one_line(&error, "no record");
    TEST_ASSERT_EQUAL_UINT32(0, back[0]);
}

static void test_what_is_no_file_is_refused(void) {
    uint32_t back = 5;
    scratch_folder("folder");
    TEST_ASSERT_EQUAL(NVM_FAILED, read_record("folder", &back, sizeof back));
    assert_one_line(&error, "cannot read");
    TEST_ASSERT_FALSE(write_record("folder", &back, sizeof back));
    assert_one_line(&error, "cannot save");
    TEST_ASSERT_FALSE(write_record("none/record", &back, sizeof back));
    assert_one_line(&error, "No such file");
    TEST_ASSERT_EQUAL_INT(0, mkfifo(scratch_path("fifo"), 0600));
    TEST_ASSERT_EQUAL(NVM_DAMAGED, read_record("fifo", &back, sizeof back)); // without waiting
    TEST_ASSERT_EQUAL_UINT32(5, back);
}

static void test_too_much_is_refused(void) {
    static uint8_t data[NVM_MAX_BYTES + 1u];
    char path[PATH_MAX];
    TEST_ASSERT_FALSE(write_record("record", data, sizeof data));
    assert_one_line(&error, "more than 16384");
    TEST_ASSERT_EQUAL(NVM_FAILED, read_record("record", data, sizeof data));
    memset(path, 'a', sizeof path - 1u);
    path[sizeof path - 1u] = '\0';
    TEST_ASSERT_FALSE(nvm_file_write(path, "param", 3, data, 4, &error));
    assert_one_line(&error, "path is too long");
    TEST_ASSERT_FALSE(scratch_has("record"));
}

static void test_leftover_of_a_cut_write_does_no_harm(void) {
    const uint32_t old = 1;
    const uint32_t other = 2;
    uint32_t back = 0;
    TEST_ASSERT_TRUE(write_record("record", &old, sizeof old));
    scratch_write("record.new", "half of a rec");
    TEST_ASSERT_EQUAL(NVM_OK, read_record("record", &back, sizeof back));
    TEST_ASSERT_EQUAL_UINT32(old, back);
    TEST_ASSERT_TRUE(write_record("record", &other, sizeof other));
    TEST_ASSERT_EQUAL(NVM_OK, read_record("record", &back, sizeof back));
    TEST_ASSERT_EQUAL_UINT32(other, back);
    TEST_ASSERT_FALSE(scratch_has("record.new"));
}

static void test_link_aside_is_not_followed(void) {
    const uint32_t value = 1;
    scratch_write("victim", "keep");
    TEST_ASSERT_EQUAL_INT(0, symlink(scratch_path("victim"), scratch_path("record.new")));
    TEST_ASSERT_FALSE(write_record("record", &value, sizeof value));
    TEST_ASSERT_EQUAL_STRING("keep", scratch_read("victim"));
}

/// A child that saves the two records in turn until it is killed; tells once it has saved.
static pid_t start_writer(int tell_fd, const uint32_t records[2][256]) {
    const pid_t child = fork();
    TEST_ASSERT_NOT_EQUAL(-1, child);
    if (child > 0) {
        return child;
    }
    for (unsigned int i = 0;; i++) {
        if (!write_record("record", records[i % 2u], sizeof records[0]) ||
            (i < 3u && write(tell_fd, "x", 1) != 1)) {
            _exit(1);
        }
    }
}

static void test_kill_in_the_middle_leaves_one_whole_record(void) {
    uint32_t records[2][256];
    uint32_t back[256];
    memset(records[0], 0x11, sizeof records[0]);
    memset(records[1], 0x77, sizeof records[1]);
    for (unsigned int round = 0; round < 20u; round++) {
        int told[2];
        char byte;
        int status;
        TEST_ASSERT_EQUAL_INT(0, pipe2(told, O_CLOEXEC));
        const pid_t child = start_writer(told[1], (const uint32_t(*)[256])records);
        for (unsigned int i = 0; i < 1u + round % 3u; i++) {
            TEST_ASSERT_EQUAL_INT(1, read(told[0], &byte, 1));
        }
        TEST_ASSERT_EQUAL_INT(0, kill(child, SIGKILL));
        TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
        TEST_ASSERT_TRUE(WIFSIGNALED(status));
        TEST_ASSERT_EQUAL_MESSAGE(NVM_OK, read_record("record", back, sizeof back), error.text);
        TEST_ASSERT_TRUE(memcmp(back, records[0], sizeof back) == 0 ||
                         memcmp(back, records[1], sizeof back) == 0);
        (void)close(told[0]);
        (void)close(told[1]);
    }
}

static void test_full_disk_keeps_what_was_there(void) {
    static const char filler[4096];
    uint32_t old[256] = {42};
    uint32_t back[256];
    scratch_folder("disk");
    if (mount("none", scratch_path("disk"), "tmpfs", 0, "size=8k") != 0) {
        TEST_IGNORE_MESSAGE("no right to mount a small file system");
    }
    const bool is_saved = write_record("disk/record", old, sizeof old);
    scratch_write_bytes("disk/filler", filler, sizeof filler);
    old[0] = 43;
    const bool is_saved_again = write_record("disk/record", old, sizeof old);
    const nvm_verdict_t verdict = read_record("disk/record", back, sizeof back);
    const bool has_leftover = scratch_has("disk/record.new");
    TEST_ASSERT_EQUAL_INT(0, umount(scratch_path("disk")));
    TEST_ASSERT_TRUE(is_saved);
    TEST_ASSERT_FALSE(is_saved_again);
    assert_one_line(&error, "No space left");
    TEST_ASSERT_EQUAL(NVM_OK, verdict);
    TEST_ASSERT_EQUAL_UINT32(42, back[0]);
    TEST_ASSERT_FALSE(has_leftover);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_record_of_any_length_comes_back);
    RUN_TEST(test_format_is_as_it_was);
    RUN_TEST(test_missing_file_is_no_damage);
    RUN_TEST(test_other_kind_version_or_length_is_damage);
    RUN_TEST(test_every_cut_and_every_flipped_bit_is_damage);
    RUN_TEST(test_what_is_no_file_is_refused);
    RUN_TEST(test_too_much_is_refused);
    RUN_TEST(test_leftover_of_a_cut_write_does_no_harm);
    RUN_TEST(test_link_aside_is_not_followed);
    RUN_TEST(test_kill_in_the_middle_leaves_one_whole_record);
    RUN_TEST(test_full_disk_keeps_what_was_there);
    return UNITY_END();
}
