#include "instance_lock.h"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "input_error.h"

namespace quiesced {

namespace {

std::string lock_file(const std::string &folder) {
    return folder + "/lock";
}

long written_pid(int fd) {
    std::array<char, 24> text{};
    const ssize_t length = pread(fd, text.data(), text.size() - 1, 0);
    return length > 0 ? std::strtol(text.data(), nullptr, 10) : 0;
}

} // namespace

InstanceLock::InstanceLock(const std::string &folder) : fd_(-1) {
    const std::string file = lock_file(folder);
    if (mkdir(folder.c_str(), 0750) != 0 && errno != EEXIST) {
        throw quiesce::InputError("state.folder: " + folder + ": " + std::strerror(errno));
    }
    fd_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
    if (fd_ < 0) {
        throw quiesce::InputError("state.folder: " + file + ": " + std::strerror(errno));
    }
    if (flock(fd_, LOCK_EX | LOCK_NB) != 0) {
        const std::string pid = std::to_string(written_pid(fd_));
        close(fd_);
        throw quiesce::InputError("quiesced runs already (process " + pid + " holds " + file + ")");
    }
    const std::string pid = std::to_string(getpid()) + "\n";
    // A full disk must not keep the controller from starting: the lock is what counts.
    if (ftruncate(fd_, 0) == 0) {
        const ssize_t ignored = pwrite(fd_, pid.data(), pid.size(), 0);
        (void)ignored;
    }
}

InstanceLock::~InstanceLock() {
    close(fd_);
}

long InstanceLock::holder(const std::string &folder) {
    const int fd = open(lock_file(folder).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (fd < 0) {
        return 0;
    }
    const bool is_free = flock(fd, LOCK_SH | LOCK_NB) == 0;
    const long pid = is_free ? 0 : written_pid(fd);
    close(fd);
    return is_free ? 0 : (pid > 0 ? pid : -1);
}

} // namespace quiesced
