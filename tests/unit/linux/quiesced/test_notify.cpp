#include <gtest/gtest.h>

#include <cstdlib>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "notify.h"
#include "temporary_folder.h"

namespace quiesced {
namespace {

/// A service manager's end: a datagram socket at a path, or abstract ("@name").
class Manager {
  public:
    explicit Manager(const std::string &name) : fd_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        name.copy(address.sun_path, sizeof address.sun_path - 1);
        if (name.front() == '@') {
            address.sun_path[0] = '\0';
        }
        const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
        EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr *>(&address), bytes), 0);
        setenv("NOTIFY_SOCKET", name.c_str(), 1);
    }
    Manager(const Manager &) = delete;
    Manager &operator=(const Manager &) = delete;
    ~Manager() {
        close(fd_);
        for (const char *name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) {
            unsetenv(name);
        }
    }

    /// "" where there is none.
    std::string receive() const {
        char text[256];
        const ssize_t length = recv(fd_, text, sizeof text, MSG_DONTWAIT);
        return length < 0 ? "" : std::string(text, static_cast<std::size_t>(length));
    }

  private:
    int fd_;
};

TEST(Notifier, reaches_a_socket_at_a_path) {
    const TemporaryFolder folder;
    const Manager manager(folder / "notify");
    Notifier().send("READY=1");
    EXPECT_EQ(manager.receive(), "READY=1");
}

TEST(Notifier, reaches_an_abstract_socket) {
    const Manager manager("@quiesced-test-" + std::to_string(getpid()));
    Notifier().send("STATUS=RUN");
    EXPECT_EQ(manager.receive(), "STATUS=RUN");
}

TEST(Notifier, never_blocks_and_survives_a_manager_that_is_gone) {
    const TemporaryFolder folder;
    auto manager = std::make_unique<Manager>(folder / "notify");
    const Notifier notifier;
    for (int i = 0; i < 10000; ++i) {
        notifier.send("STATUS=x");
    }
    manager.reset();
    notifier.send("STATUS=y");
}

TEST(Notifier, is_silent_without_a_manager) {
    unsetenv("NOTIFY_SOCKET");
    setenv("WATCHDOG_USEC", "2000000", 1);
    const Notifier notifier;
    notifier.send("READY=1");
    EXPECT_EQ(notifier.watchdog_period_ns(), 0);
    unsetenv("WATCHDOG_USEC");
}

TEST(Notifier, takes_half_of_the_watchdogs_timeout) {
    const TemporaryFolder folder;
    const Manager manager(folder / "notify");
    setenv("WATCHDOG_USEC", "2000000", 1);
    EXPECT_EQ(Notifier().watchdog_period_ns(), 1'000'000'000);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    EXPECT_EQ(Notifier().watchdog_period_ns(), 1'000'000'000);
    setenv("WATCHDOG_PID", "1", 1); // of another process
    EXPECT_EQ(Notifier().watchdog_period_ns(), 0);
}

TEST(Notifier, ignores_a_malformed_environment) {
    for (const char *name : {"", "x", "relative", "/no/such/socket"}) {
        setenv("NOTIFY_SOCKET", name, 1);
        Notifier().send("READY=1");
    }
    setenv("NOTIFY_SOCKET", std::string(500, '/').c_str(), 1);
    Notifier().send("READY=1");
    const TemporaryFolder folder;
    const Manager manager(folder / "notify");
    for (const char *time : {"", "-1", "0", "1s", "99999999999999999999"}) {
        setenv("WATCHDOG_USEC", time, 1);
        EXPECT_EQ(Notifier().watchdog_period_ns(), 0) << time;
    }
}

} // namespace
} // namespace quiesced
