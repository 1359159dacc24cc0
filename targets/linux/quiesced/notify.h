/// sd_notify's protocol (sd_notify(3)): datagrams to $NOTIFY_SOCKET, and how often $WATCHDOG_USEC
/// wants to hear from us. Not by libsystemd: it opens a socket for each message and waits while the
/// manager does not read; this neither waits nor allocates.
#ifndef QUIESCED_NOTIFY_H
#define QUIESCED_NOTIFY_H

#include <cstdint>
#include <string_view>

namespace quiesced {

class Notifier {
  public:
    /// Reads the environment. Without a service manager everything is a no-op.
    Notifier();
    Notifier(const Notifier &) = delete;
    Notifier &operator=(const Notifier &) = delete;
    ~Notifier();

    /// "READY=1", lines separated by newlines. Never blocks; a manager that is gone is no error.
    /// Needs no heap.
    void send(std::string_view state) const;

    /// Half the watchdog's timeout; 0: nobody watches.
    std::int64_t watchdog_period_ns() const { return watchdog_period_ns_; }

  private:
    int socket_ = -1;
    std::int64_t watchdog_period_ns_ = 0;
};

} // namespace quiesced

#endif
