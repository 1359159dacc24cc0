/// What is a whole table file, and what a user reads where one is not.
#include "table_container.h"

#include <gtest/gtest.h>

#include <functional>

#include "input_error.h"
#include "table_files.h"

namespace {

using quiesce::bytes_of;
using quiesce::file_bytes;
using quiesce::head_of;
using quiesce::InputError;
using quiesce::read_table;
using quiesce::TempFile;
using quiesce::Words;

const Words kTable = {1, 2, 5, 4, 5};

std::string message_of(const std::string &file) {
    try {
        read_table(file);
    } catch (const InputError &error) {
        return error.what();
    }
    return "accepted";
}

TEST(TableContainer, has_its_board_and_its_words) {
    const TempFile any(kTable);
    EXPECT_EQ(read_table(any.name()).board, 0u);
    EXPECT_EQ(read_table(any.name()).words, kTable);
    const TempFile stamped(kTable, 0x89ABCDEFu);
    EXPECT_EQ(read_table(stamped.name()).board, 0x89ABCDEFu);
}

TEST(TableContainer, the_largest_and_the_smallest_are_read) {
    for (const std::size_t count : {quiesce::kLeastTableWords, quiesce::kMostTableWords}) {
        const TempFile file(Words(count, 7));
        EXPECT_EQ(read_table(file.name()).words.size(), count);
    }
}

TEST(TableContainer, bytes_are_little_endian) {
    EXPECT_EQ(file_bytes({0x31475351u, 0, 0, 0x80FF7F01u}),
              std::string("QTF1\0\0\0\0\4\0\0\0", 12) + bytes_of({head_of(4)[3]}) +
                  std::string("QSG1\0\0\0\0\0\0\0\0\1\x7F\xFF\x80", 16));
}

struct Damage {
    const char *name;
    std::function<std::string()> bytes;
    const char *message;
};

void PrintTo(const Damage &damage, std::ostream *out) {
    *out << damage.name;
}

std::string changed(std::size_t at) {
    std::string bytes = file_bytes(kTable);
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    return bytes;
}

const Damage kDamages[] = {
    {"empty", [] { return std::string(); }, ": not a table file; `quiesce table pack`"},
    {"text", [] { return std::string("31475351\n00000000\n00000004\n00000001\n"); },
     ": not a table file"},
    {"bare_words", [] { return bytes_of(kTable); }, ": not a table file"},
    {"half_a_head", [] { return file_bytes(kTable).substr(0, 15); }, ": not a table file"},
    {"magic", [] { return changed(3); }, ": not a table file"},
    {"board", [] { return changed(4); }, ": the CRC-32 of its head is wrong: it is damaged"},
    {"count", [] { return changed(8); }, ": the CRC-32 of its head is wrong: it is damaged"},
    {"crc", [] { return changed(12); }, ": the CRC-32 of its head is wrong: it is damaged"},
    {"too_long", [] { return file_bytes(Words(2049, 0)); },
     ": a table of 2049 words, 8196 bytes; a controller takes 2048 words, 8192 bytes"},
    {"far_too_long", [] { return bytes_of(head_of(UINT32_MAX)); },
     ": a table of 4294967295 words, 17179869180 bytes; a controller takes 2048 words"},
    {"no_words", [] { return bytes_of(head_of(0)); },
     ": a table of 0 words, 0 bytes; one has at least 4 words, 16 bytes"},
    {"head_only", [] { return bytes_of(head_of(5)); },
     ": ends after 0 words, 0 bytes where its head says 5 words, 20 bytes"},
    {"cut_by_a_byte",
     [] {
         std::string bytes = file_bytes(kTable);
         bytes.pop_back();
         return bytes;
     },
     ": ends after 4 words, 16 bytes where its head says 5 words, 20 bytes"},
    {"a_byte_more", [] { return file_bytes(kTable) + '\n'; },
     ": goes on after the 5 words, 20 bytes that its head says"},
};

class DamagedTableFile : public testing::TestWithParam<Damage> {};

TEST_P(DamagedTableFile, is_refused_with_file_and_reason) {
    const TempFile file(GetParam().bytes());
    const std::string message = message_of(file.name());
    EXPECT_EQ(message.rfind(file.name() + GetParam().message, 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(TableContainer, DamagedTableFile, testing::ValuesIn(kDamages),
                         [](const auto &test) { return std::string(test.param.name); });

TEST(TableContainer, missing_file_and_folder_are_told) {
    EXPECT_EQ(message_of("no/such/file"), "no/such/file: cannot be read; name a table file");
    const std::string folder = std::filesystem::temp_directory_path().string();
    EXPECT_EQ(message_of(folder), folder + ": cannot be read; name a table file");
}

} // namespace
