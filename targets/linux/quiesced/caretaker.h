/// A process that outlives the controller: however that ends, by a signal that nobody can catch, a
/// crash, or the kernel's want of memory, its outputs are made safe and its latched fault is kept.
#ifndef QUIESCED_CARETAKER_H
#define QUIESCED_CARETAKER_H

#include <atomic>
#include <cstdint>
#include <string>

#include <sys/types.h>

namespace quiesced {

class Caretaker {
  public:
    /// Starts it: before any other thread is, and before anything is switched on. It holds the
    /// instance lock, too, until it has done its work. latched_fault: in memory that both share.
    Caretaker(std::string config_file, std::string state_folder,
              const std::atomic<std::uint32_t> &latched_fault);
    Caretaker(const Caretaker &) = delete;
    Caretaker &operator=(const Caretaker &) = delete;

    /// The controller's orderly end: there is nothing to do for it. Waits for it.
    ~Caretaker();

    /// True once: it was killed itself.
    bool has_ended();

  private:
    [[noreturn]] void live(pid_t controller, int listen_fd) const;
    void take_over(pid_t controller) const;
    void keep_fault() const;

    std::string config_file_;
    std::string state_folder_;
    const std::atomic<std::uint32_t> &latched_fault_;
    int say_fd_ = -1; ///< a pipe that ends with the controller
    pid_t process_ = -1;
};

} // namespace quiesced

#endif
