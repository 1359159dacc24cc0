// The fault record on the disk.
#include <gtest/gtest.h>

#include <filesystem>

#include "record_store.h"
#include "temporary_folder.h"

namespace quiesced {
namespace {

KeptRecord record_of(std::uint32_t word) {
    KeptRecord record{};
    record.is_held = 1;
    record.words.fill(word);
    return record;
}

TEST(RecordStore, keeps_the_last_one) {
    const TemporaryFolder folder;
    RecordStore store(folder.path());
    std::string note = "x";
    EXPECT_EQ(store.load(note).is_held, 0U);
    EXPECT_EQ(note, "");
    ASSERT_EQ(store.keep({}), ""); // as a start does
    for (std::uint32_t i = 0; i < 5; ++i) {
        ASSERT_EQ(store.keep(record_of(i)), "");
        const KeptRecord found = RecordStore(folder.path()).load(note);
        EXPECT_EQ(found.is_held, 1U);
        EXPECT_EQ(found.words, record_of(i).words);
    }
    ASSERT_EQ(store.keep({}), "");
    EXPECT_EQ(store.load(note).is_held, 0U);
    EXPECT_EQ(std::filesystem::file_size(store.file()), 8192U);
}

TEST(RecordStore, a_damaged_one_is_told_and_replaced) {
    const TemporaryFolder folder;
    RecordStore store(folder.path());
    ASSERT_EQ(store.keep(record_of(7)), "");
    const std::string whole = read_text(store.file());
    for (const std::size_t at : {0U, 100U, 1900U, 4096U, 5500U}) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 1);
        write_text(store.file(), damaged);
        std::string note;
        EXPECT_EQ(store.load(note).is_held, 0U) << at;
        EXPECT_EQ(note.rfind("the fault record is not used: ", 0), 0U) << note;
    }
    EXPECT_EQ(RecordStore(folder.path()).keep(record_of(8)), "");
    std::string note;
    EXPECT_EQ(store.load(note).words, record_of(8).words);
    EXPECT_NE(RecordStore("/no/such/folder").keep({}), "");
}

} // namespace
} // namespace quiesced
