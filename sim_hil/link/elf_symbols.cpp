#include "elf_symbols.h"

#include <cstring>
#include <elf.h>
#include <fstream>
#include <iterator>

#include "input_error.h"

namespace quiesce {

namespace {

class Image {
  public:
    explicit Image(const std::string &path) : path_(path) {
        std::ifstream file(path, std::ios::binary);
        if (!file) {
            throw InputError("image " + path +
                             ": cannot be read; build it with: cmake --preset mps2 && cmake "
                             "--build --preset mps2");
        }
        bytes_.assign(std::istreambuf_iterator<char>(file), {});
    }

    [[noreturn]] void refuse() const {
        throw InputError("image " + path_ + ": is no 32-bit Arm executable with symbols");
    }

    template <typename Record>
    Record at(std::size_t offset) const {
        Record record;
        if (offset > bytes_.size() || bytes_.size() - offset < sizeof record) {
            refuse();
        }
        std::memcpy(&record, bytes_.data() + offset, sizeof record);
        return record;
    }

    std::string text(std::size_t offset) const {
        const std::size_t end = bytes_.find('\0', offset);
        if (offset >= bytes_.size() || end == std::string::npos) {
            refuse();
        }
        return bytes_.substr(offset, end - offset);
    }

  private:
    std::string path_;
    std::string bytes_;
};

Elf32_Ehdr read_header(const Image &image) {
    const auto header = image.at<Elf32_Ehdr>(0);
    if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
        header.e_ident[EI_CLASS] != ELFCLASS32 || header.e_ident[EI_DATA] != ELFDATA2LSB ||
        header.e_machine != EM_ARM || header.e_shentsize != sizeof(Elf32_Shdr)) {
        image.refuse();
    }
    return header;
}

Elf32_Shdr read_section(const Image &image, const Elf32_Ehdr &header, std::size_t index) {
    if (index >= header.e_shnum) {
        image.refuse();
    }
    return image.at<Elf32_Shdr>(header.e_shoff + index * sizeof(Elf32_Shdr));
}

void read_table(const Image &image, const Elf32_Shdr &table, const Elf32_Shdr &names,
                std::map<std::string, std::uint32_t> &symbols) {
    for (std::size_t at = 0; at + sizeof(Elf32_Sym) <= table.sh_size; at += sizeof(Elf32_Sym)) {
        const auto symbol = image.at<Elf32_Sym>(std::size_t{table.sh_offset} + at);
        if (symbol.st_name != 0) {
            const bool is_function = ELF32_ST_TYPE(symbol.st_info) == STT_FUNC;
            const std::uint32_t address = is_function ? symbol.st_value & ~1u : symbol.st_value;
            symbols[image.text(std::size_t{names.sh_offset} + symbol.st_name)] = address;
        }
    }
}

} // namespace

std::map<std::string, std::uint32_t> read_elf_symbols(const std::string &path) {
    const Image image(path);
    const Elf32_Ehdr header = read_header(image);
    std::map<std::string, std::uint32_t> symbols;
    for (std::size_t index = 0; index < header.e_shnum; ++index) {
        const Elf32_Shdr section = read_section(image, header, index);
        if (section.sh_type == SHT_SYMTAB) {
            read_table(image, section, read_section(image, header, section.sh_link), symbols);
        }
    }
    if (symbols.empty()) {
        image.refuse();
    }
    return symbols;
}

} // namespace quiesce
