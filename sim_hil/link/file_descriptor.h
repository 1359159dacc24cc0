/// Owner of one file descriptor.
#ifndef QUIESCE_FILE_DESCRIPTOR_H
#define QUIESCE_FILE_DESCRIPTOR_H

#include <string>

namespace quiesce {

class FileDescriptor {
  public:
    FileDescriptor() = default;
    explicit FileDescriptor(int number) : number_(number) {}
    FileDescriptor(FileDescriptor &&other) noexcept : number_(other.release()) {}
    FileDescriptor &operator=(FileDescriptor &&other) noexcept;
    ~FileDescriptor() { close(); }

    int number() const { return number_; }
    void close();

  private:
    int release();

    int number_ = -1;
};

/// File in memory, without a name, that a child process may inherit. It is gone when the last
/// descriptor is. Throws std::system_error where the system has none left.
FileDescriptor make_memory_file(const char *label, long size_bytes);

/// Everything written to a memory file so far.
std::string read_memory_file(const FileDescriptor &file);

} // namespace quiesce

#endif
