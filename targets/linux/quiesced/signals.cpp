#include "signals.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <initializer_list>

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

sigset_t our_signals() {
    sigset_t set;
    sigemptyset(&set);
    for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) {
        sigaddset(&set, number);
    }
    return set;
}

} // namespace

void install_signals() {
    const sigset_t set = our_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_mask = set;
    for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) {
        sigaction(number, &action, nullptr);
    }
    action.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &action, nullptr);
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
