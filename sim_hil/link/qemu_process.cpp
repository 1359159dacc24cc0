#include "qemu_process.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "input_error.h"

namespace quiesce {

namespace {

const char *const kProgram = "qemu-system-arm";
constexpr std::chrono::milliseconds kPollInterval(2);
constexpr std::chrono::milliseconds kTerminateTime(1000);

std::vector<std::string> command_line(const std::string &image_path,
                                      const std::vector<std::string> &extra) {
    std::vector<std::string> words = {kProgram,
                                      "-display",
                                      "none",
                                      "-monitor",
                                      "none",
                                      "-semihosting-config",
                                      "enable=on,target=native",
                                      "-kernel",
                                      image_path};
    words.insert(words.end(), extra.begin(), extra.end());
    return words;
}

std::vector<char *> as_argv(std::vector<std::string> &words) {
    std::vector<char *> argv;
    argv.reserve(words.size() + 1);
    for (std::string &word : words) {
        argv.push_back(word.data());
    }
    argv.push_back(nullptr);
    return argv;
}

/// In the child, between fork and exec: async-signal-safe calls only. Returns only on failure.
void become_qemu(char *const *argv, const std::vector<int> &inherited, int output, pid_t parent) {
    const int null = open("/dev/null", O_RDONLY);
    dup2(null, STDIN_FILENO);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    for (const int number : inherited) {
        fcntl(number, F_SETFD, 0);
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == parent) {
        execvp(argv[0], argv);
    }
}

[[noreturn]] void report_start_failure(int error) {
    if (error == ENOENT) {
        throw InputError(std::string(kProgram) +
                         " not found: install it (Debian: qemu-system-arm) or run ./tools/hil");
    }
    throw InputError(std::string(kProgram) + " cannot be started: " + std::strerror(error));
}

std::string last_line(const std::string &text) {
    const std::size_t end = text.find_last_not_of("\r\n");
    if (end == std::string::npos) {
        return "it printed nothing";
    }
    const std::size_t before = text.find_last_of("\r\n", end);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    return text.substr(begin, end + 1 - begin);
}

} // namespace

QemuProcess::QemuProcess(const std::string &image_path, const std::vector<std::string> &extra,
                         const std::vector<int> &inherited)
    : output_(make_memory_file("qemu-output", 0)) {
    std::vector<std::string> words = command_line(image_path, extra);
    const std::vector<char *> argv = as_argv(words);
    int report[2]; // carries errno when exec fails, closes by itself when it succeeds
    if (pipe2(report, O_CLOEXEC) != 0) {
        report_start_failure(errno);
    }
    const FileDescriptor report_read(report[0]);
    FileDescriptor report_write(report[1]);
    const pid_t parent = getpid();
    id_ = fork();
    if (id_ == 0) {
        become_qemu(argv.data(), inherited, output_.number(), parent);
        const int error = errno;
        [[maybe_unused]] const ssize_t written = write(report[1], &error, sizeof error);
        _exit(127);
    }
    if (id_ < 0) {
        report_start_failure(errno);
    }
    is_running_ = true;
    report_write.close();
    int error = 0;
    if (read(report_read.number(), &error, sizeof error) == sizeof error) {
        reap(0);
        report_start_failure(error);
    }
}

QemuProcess::~QemuProcess() {
    if (!is_running()) {
        return;
    }
    kill(id_, SIGTERM);
    kill(id_, SIGCONT);
    if (!wait_for_end(kTerminateTime)) {
        kill(id_, SIGKILL);
        reap(0);
    }
}

void QemuProcess::reap(int options) {
    pid_t ended;
    do {
        ended = waitpid(id_, &status_, options);
    } while (ended < 0 && errno == EINTR);
    if (ended != 0) {
        is_running_ = false;
    }
}

bool QemuProcess::is_running() {
    if (is_running_) {
        reap(WNOHANG);
    }
    return is_running_;
}

bool QemuProcess::wait_for_end(std::chrono::milliseconds time) {
    const auto deadline = std::chrono::steady_clock::now() + time;
    while (is_running() && std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(kPollInterval);
    }
    return !is_running_;
}

bool QemuProcess::has_succeeded() const {
    return !is_running_ && WIFEXITED(status_) && WEXITSTATUS(status_) == 0;
}

std::string QemuProcess::describe_end() const {
    const std::string how = WIFSIGNALED(status_)
                                ? "was killed by signal " + std::to_string(WTERMSIG(status_))
                                : "ended with code " + std::to_string(WEXITSTATUS(status_));
    return std::string(kProgram) + " " + how + ": " + last_line(output());
}

std::string QemuProcess::output() const {
    return read_memory_file(output_);
}

void QemuProcess::pause() {
    kill(id_, SIGSTOP);
}

void QemuProcess::resume() {
    kill(id_, SIGCONT);
}

} // namespace quiesce
