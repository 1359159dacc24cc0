#include "instance_lock.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clock.h"
#include "input_error.h"

namespace quiesced {

namespace {

std::string lock_file(const std::string &folder) {
    return folder + "/lock";
}

constexpr int kCaretakerPatience_ms = 10'000;
constexpr int kPause_ms = 10;

long written_pid(int fd) {
    std::array<char, 24> text{};
    const ssize_t length = pread(fd, text.data(), text.size() - 1, 0);
    return length > 0 ? std::strtol(text.data(), nullptr, 10) : 0;
}

/// Where the process that took it is no more its caretaker still makes the outputs safe: a while.
bool take_lock(int fd, int operation) {
    for (int waited_ms = 0;; waited_ms += kPause_ms) {
        if (flock(fd, operation | LOCK_NB) == 0) {
            return true;
        }
        const long pid = written_pid(fd);
        const bool is_gone = pid > 0 && kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH;
        if (!is_gone || waited_ms >= kCaretakerPatience_ms) {
            return false;
        }
        sleep_ms(kPause_ms);
    }
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
    if (!take_lock(fd_, LOCK_EX)) {
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
    const bool is_free = take_lock(fd, LOCK_SH);
    const long pid = is_free ? 0 : written_pid(fd);
    close(fd);
    return is_free ? 0 : (pid > 0 ? pid : -1);
}

} // namespace quiesced
