/// Symbols of a cross-compiled image, read from the ELF file itself.
#ifndef QUIESCE_ELF_SYMBOLS_H
#define QUIESCE_ELF_SYMBOLS_H

#include <cstdint>
#include <map>
#include <string>

namespace quiesce {

/// Name -> address of every named symbol of a 32-bit little-endian Arm executable; the Thumb bit of
/// functions is cleared. Throws InputError when the file cannot be read or is no such executable.
std::map<std::string, std::uint32_t> read_elf_symbols(const std::string &path);

} // namespace quiesce

#endif
