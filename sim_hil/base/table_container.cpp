#include "table_container.h"

#include <array>
#include <fstream>

#include "crc32.h"
#include "input_error.h"

namespace quiesce {

namespace {

constexpr std::uint32_t kMagic = 0x31465451; // "QTF1"
constexpr std::size_t kWordBytes = 4;
enum Head : std::size_t { kMagicAt, kBoardAt, kCountAt, kCrcAt, kHeadWords };

InputError refused(const std::string &file, const std::string &why) {
    return InputError(file + ": " + why);
}

std::string bytes_text(std::size_t words) {
    return std::to_string(words) + " words, " + std::to_string(kWordBytes * words) + " bytes";
}

/// As many whole little-endian words as there are, at most `count`. Throws where it cannot be read.
std::vector<std::uint32_t> words_of(std::istream &stream, const std::string &file,
                                    std::size_t count) {
    std::vector<char> bytes(kWordBytes * count);
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (stream.bad()) {
        throw refused(file, "cannot be read; name a table file");
    }
    std::vector<std::uint32_t> words(static_cast<std::size_t>(stream.gcount()) / kWordBytes);
    for (std::size_t i = 0; i < kWordBytes * words.size(); ++i) {
        words[i / kWordBytes] |= std::uint32_t{static_cast<unsigned char>(bytes[i])}
                                 << (8U * (i % kWordBytes));
    }
    return words;
}

void check_head(const std::vector<std::uint32_t> &head, const std::string &file) {
    if (head.size() < kHeadWords || head[kMagicAt] != kMagic) {
        throw refused(file, "not a table file; `quiesce table pack` makes one of bare words");
    }
    if (crc32_of(head.data(), kCrcAt) != head[kCrcAt]) {
        throw refused(file, "the CRC-32 of its head is wrong: it is damaged; copy or make it anew");
    }
    if (head[kCountAt] > kMostTableWords) {
        throw refused(file, "a table of " + bytes_text(head[kCountAt]) + "; a controller takes " +
                                bytes_text(kMostTableWords));
    }
    if (head[kCountAt] < kLeastTableWords) {
        throw refused(file, "a table of " + bytes_text(head[kCountAt]) + "; one has at least " +
                                bytes_text(kLeastTableWords));
    }
}

} // namespace

TableContainer read_table(const std::string &file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw refused(file, "cannot be read; name a table file");
    }
    const std::vector<std::uint32_t> head = words_of(stream, file, kHeadWords);
    check_head(head, file);
    TableContainer out{head[kBoardAt], words_of(stream, file, head[kCountAt])};
    if (out.words.size() < head[kCountAt]) {
        throw refused(file, "ends after " + bytes_text(out.words.size()) + " where its head says " +
                                bytes_text(head[kCountAt]) + "; copy or make it anew");
    }
    if (stream.peek() != std::ifstream::traits_type::eof()) {
        throw refused(file, "goes on after the " + bytes_text(head[kCountAt]) +
                                " that its head says; copy or make it anew");
    }
    return out;
}

} // namespace quiesce
