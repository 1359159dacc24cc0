#include "file_descriptor.h"

#include <array>
#include <cerrno>
#include <sys/mman.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace quiesce {

FileDescriptor &FileDescriptor::operator=(FileDescriptor &&other) noexcept {
    if (this != &other) {
        close();
        number_ = other.release();
    }
    return *this;
}

void FileDescriptor::close() {
    if (number_ >= 0) {
        ::close(number_);
        number_ = -1;
    }
}

int FileDescriptor::release() {
    return std::exchange(number_, -1);
}

FileDescriptor make_memory_file(const char *label, long size_bytes) {
    FileDescriptor file(memfd_create(label, MFD_CLOEXEC));
    if (file.number() < 0 || ftruncate(file.number(), size_bytes) != 0) {
        throw std::system_error(errno, std::generic_category(), label);
    }
    return file;
}

std::string read_memory_file(const FileDescriptor &file) {
    std::string text;
    std::array<char, 4096> block;
    for (;;) {
        const ssize_t count =
            pread(file.number(), block.data(), block.size(), static_cast<off_t>(text.size()));
        if (count <= 0) {
            return text;
        }
        text.append(block.data(), static_cast<std::size_t>(count));
    }
}

} // namespace quiesce
