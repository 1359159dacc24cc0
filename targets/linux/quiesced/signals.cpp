#include "signals.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>

#include <fcntl.h>
#include <unistd.h>

namespace quiesced {

namespace {

// A handler reaches nothing but globals.
std::atomic<bool> stop_requested{false};
std::atomic<bool> reload_requested{false};
std::atomic<bool> status_requested{false};
std::atomic<int> wake{-1};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "flags of a signal handler");

void on_signal(int number) {
    const int saved = errno;
    (number == SIGHUP    ? reload_requested
     : number == SIGUSR1 ? status_requested
                         : stop_requested)
        .store(true);
    const std::uint64_t one = 1;
    const int fd = wake.load();
    if (fd >= 0) {
        const ssize_t ignored = write(fd, &one, sizeof one);
        (void)ignored;
    }
    errno = saved;
}

/// Whatever a process can catch and end after, but what a fault of the program itself raises: there
/// its caretaker acts.
bool is_ours(int number) {
    switch (number) {
    case SIGKILL:
    case SIGSTOP:
    case SIGILL:
    case SIGTRAP:
    case SIGABRT:
    case SIGBUS:
    case SIGFPE:
    case SIGSEGV:
    case SIGSYS:
        return false;
    default:
        return true;
    }
}

/// Of the others: no reason to end, or to stop with the driver on.
bool is_ignored(int number) {
    switch (number) {
    case SIGPIPE:
    case SIGXFSZ:
    case SIGTSTP:
    case SIGTTIN:
    case SIGTTOU:
    case SIGCHLD:
    case SIGCONT:
    case SIGURG:
    case SIGWINCH:
        return true;
    default:
        return false;
    }
}

sigset_t our_signals() {
    sigset_t set;
    sigemptyset(&set);
    for (int number = 1; number <= SIGRTMAX; ++number) {
        if (is_ours(number) && !is_ignored(number)) {
            sigaddset(&set, number);
        }
    }
    return set;
}

} // namespace

void install_signals() {
    const sigset_t set = our_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    struct sigaction action {};
    action.sa_mask = set;
    for (int number = 1; number <= SIGRTMAX; ++number) {
        action.sa_handler = is_ignored(number) ? SIG_IGN : on_signal;
        if (is_ours(number) && number != SIGCHLD) {
            (void)sigaction(number, &action, nullptr); // the C library keeps two for itself
        }
    }
}

void take_signals(int wake_fd) {
    wake.store(wake_fd);
    const sigset_t set = our_signals();
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

bool stop_is_requested() {
    return stop_requested.load();
}

bool take_reload_request() {
    return reload_requested.exchange(false);
}

bool take_status_request() {
    return status_requested.exchange(false);
}

void reserve_standard_files() {
    int fd = 0;
    do {
        fd = open("/dev/null", O_RDWR | O_NOCTTY);
    } while (fd >= 0 && fd <= STDERR_FILENO);
    if (fd > STDERR_FILENO) {
        close(fd);
    }
}

} // namespace quiesced
