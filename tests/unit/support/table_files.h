/// Table files for tests (docs/reference/table-files.md), good and damaged.
#ifndef QUIESCE_TEST_TABLE_FILES_H
#define QUIESCE_TEST_TABLE_FILES_H

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "crc32.h"

namespace quiesce {

using Words = std::vector<std::uint32_t>;

inline std::string bytes_of(const Words &words) {
    std::string bytes;
    for (const std::uint32_t word : words) {
        for (unsigned shift = 0; shift < 32; shift += 8) {
            bytes.push_back(static_cast<char>(word >> shift & 0xFFu));
        }
    }
    return bytes;
}

/// A file's head for a table of so many words, with its CRC.
inline Words head_of(std::uint32_t count, std::uint32_t board = 0) {
    Words head = {0x31465451u, board, count};
    head.push_back(crc32_of(head.data(), head.size()));
    return head;
}

inline std::string file_bytes(const Words &words, std::uint32_t board = 0) {
    return bytes_of(head_of(static_cast<std::uint32_t>(words.size()), board)) + bytes_of(words);
}

/// The table's own CRC, word 1, anew.
inline Words with_crc(Words words) {
    words[1] = crc32_of(words.data() + 2, words.size() - 2);
    return words;
}

/// A file that goes with the object.
class TempFile {
  public:
    explicit TempFile(const std::string &bytes)
        : name_((std::filesystem::temp_directory_path() /
                 ("quiesce_table_" + std::to_string(::getpid()) + "_" + std::to_string(made_++)))
                    .string()) {
        std::ofstream(name_, std::ios::binary) << bytes;
    }
    explicit TempFile(const Words &table, std::uint32_t board = 0)
        : TempFile(file_bytes(table, board)) {}
    ~TempFile() { std::filesystem::remove(name_); }
    TempFile(const TempFile &) = delete;
    TempFile &operator=(const TempFile &) = delete;

    const std::string &name() const { return name_; }

  private:
    inline static int made_ = 0;
    std::string name_;
};

} // namespace quiesce

#endif
