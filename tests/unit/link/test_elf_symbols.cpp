#include <filesystem>
#include <fstream>
#include <iterator>

#include "elf_symbols.h"
#include "images.h"

namespace quiesce {
namespace {

std::string write_file(const std::string &name, const std::string &bytes) {
    const std::string path = testing::TempDir() + name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
}

std::string bytes_of(const std::string &path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(elf_symbols, finds_the_markers_around_one_call) {
    for (const std::string &image : {kShmImage, kUartImage}) {
        const auto symbols = read_elf_symbols(image);
        EXPECT_EQ(symbols.at("quiesce_count_end") - symbols.at("quiesce_count_begin"), 4u);
        EXPECT_EQ(symbols.at("main") % 2, 0u); // no Thumb bit
    }
}

TEST(elf_symbols, missing_file_says_how_to_build_it) {
    const std::string error = error_of([] { read_elf_symbols("no/such.elf"); });
    expect_contains(error, "image no/such.elf: cannot be read");
    expect_contains(error, "cmake --build --preset mps2");
}

TEST(elf_symbols, other_files_are_refused) {
    const std::string text = write_file("not.elf", "this is text");
    expect_contains(error_of([&] { read_elf_symbols(text); }), "is no 32-bit Arm executable");
    expect_contains(error_of([] { read_elf_symbols("/proc/self/exe"); }), "is no 32-bit Arm");
}

TEST(elf_symbols, every_truncated_image_is_refused_or_read) {
    const std::string whole = bytes_of(kEchoImage);
    ASSERT_GT(whole.size(), 1000u);
    int refused = 0;
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 300) {
        const std::string path = write_file("cut.elf", whole.substr(0, size));
        try {
            read_elf_symbols(path);
        } catch (const InputError &) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 290);
}

TEST(elf_symbols, damaged_headers_are_refused_or_read) {
    const std::string whole = bytes_of(kEchoImage);
    for (std::size_t at = 0; at < 52; ++at) { // the ELF header
        for (const char value : {'\0', '\x7F', '\xFF'}) {
            std::string damaged = whole;
            damaged[at] = value;
            const std::string path = write_file("damaged.elf", damaged);
            try {
                read_elf_symbols(path);
            } catch (const InputError &error) {
                expect_contains(error.what(), "image ");
            }
        }
    }
}

} // namespace
} // namespace quiesce
