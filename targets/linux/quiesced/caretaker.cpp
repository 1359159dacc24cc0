#include "caretaker.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clock.h"
#include "fault_store.h"
#include "input_error.h"
#include "make_safe.h"
#include "names.h"

namespace quiesced {

namespace {

constexpr int kEndPatience_ms = 10'000;
constexpr int kBlindPause_ms = 300; // where the kernel does not tell of a process's end

/// Its files are closed, its lines are free. The pipe ends earlier.
void wait_for_end(int process_fd) {
    pollfd ended = {process_fd, POLLIN, 0};
    if (process_fd < 0) {
        sleep_ms(kBlindPause_ms);
    } else {
        (void)poll(&ended, 1, kEndPatience_ms);
    }
}

/// Returns true iff the controller has said that all is done.
bool await_word(int listen_fd) {
    char word = 0;
    ssize_t got = 0;
    do {
        got = read(listen_fd, &word, sizeof word);
    } while (got < 0 && errno == EINTR);
    return got == 1;
}

void tell(const std::string &line) {
    (void)std::fprintf(stderr, "quiesced: %s\n", line.c_str());
}

} // namespace

Caretaker::Caretaker(std::string config_file, std::string state_folder,
                     const std::atomic<std::uint32_t> &latched_fault)
    : config_file_(std::move(config_file)), state_folder_(std::move(state_folder)),
      latched_fault_(latched_fault) {
    std::array<int, 2> ends{};
    const pid_t controller = getpid();
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
        throw quiesce::InputError("cannot start the caretaker: no pipe");
    }
    process_ = fork();
    if (process_ == 0) {
        close(ends[1]);
        live(controller, ends[0]);
    }
    close(ends[0]);
    say_fd_ = ends[1];
    if (process_ < 0) {
        close(say_fd_);
        throw quiesce::InputError("cannot start the caretaker: no further process is allowed");
    }
}

Caretaker::~Caretaker() {
    const char word = 'd';
    const ssize_t ignored = write(say_fd_, &word, sizeof word);
    (void)ignored;
    close(say_fd_);
    if (process_ > 0) {
        (void)waitpid(process_, nullptr, 0);
    }
}

bool Caretaker::has_ended() {
    const bool is_news = process_ > 0 && waitpid(process_, nullptr, WNOHANG) == process_;
    process_ = is_news ? -1 : process_;
    return is_news;
}

/// What ends a service or a terminal's programs reaches it, too: it is not done yet.
void Caretaker::live(pid_t controller, int listen_fd) const {
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, nullptr);
    (void)prctl(PR_SET_NAME, "quiesced-care", 0UL, 0UL, 0UL);
    const int process_fd = static_cast<int>(syscall(SYS_pidfd_open, controller, 0));
    if (!await_word(listen_fd)) {
        wait_for_end(process_fd);
        take_over(controller);
    }
    _exit(0);
}

void Caretaker::take_over(pid_t controller) const {
    tell("process " + std::to_string(controller) +
         " was killed or has crashed: its outputs are made safe");
    keep_fault(); // a moment; the driver is off in the tick of a fault
    try {
        const bool is_safe = make_outputs_safe(config_file_, state_folder_, SystemFolders()) == 0;
        tell(is_safe ? "its outputs are safe" : "not all of its outputs could be made safe");
    } catch (const std::exception &error) {
        tell(error.what());
    }
}

/// The controller's other thread may not have come to it.
void Caretaker::keep_fault() const {
    const std::uint32_t fault = latched_fault_.load();
    std::string note;
    FaultStore store(state_folder_);
    if (fault == QUIESCE_FAULT_NONE || store.load(note) != QUIESCE_FAULT_NONE) {
        return;
    }
    const std::string error = store.keep(fault);
    tell(error.empty()
             ? std::string("fault ") + fault_name(fault) + " is kept until it is acknowledged"
             : "latched fault: not written: " + error);
}

} // namespace quiesced
