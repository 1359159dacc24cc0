/// Why ticks are lost: counted by cause, for the log and the status file.
#ifndef QUIESCED_LOST_TICKS_H
#define QUIESCED_LOST_TICKS_H

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware.h"

namespace quiesced {

enum class LossCause : std::size_t {
    work,        ///< a tick's own work took longer than a tick
    no_priority, ///< other processes had the CPU: the thread has no real-time priority (any more)
    latency,     ///< it has: kernel, hypervisor, or another real-time process
    line,        ///< the data-ready line had no edge in time
};
constexpr std::size_t kLossCauses = 4;
using LossCounts = std::array<std::uint32_t, kLossCauses>;

/// For the status file, and for the log.
const char *loss_name(LossCause cause);
const char *loss_text(LossCause cause);

/// What a thread of the kernel says of itself; a test has another one.
struct ThreadState {
    bool is_realtime;
    std::uint32_t preemptions; ///< since its start
};
ThreadState this_thread();

class LostTicks {
  public:
    /// At the start of a tick before which some were lost. timing: of this tick, with the work of
    /// the one before; has_line: a line's edges are the ticks.
    void count(std::uint32_t lost, const hal_tick_t &timing, bool has_line,
               const ThreadState &thread);

    const LossCounts &counts() const { return counts_; }
    LossCause last() const { return last_; }

  private:
    LossCause cause_of(const hal_tick_t &timing, bool has_line, const ThreadState &thread) const;

    LossCounts counts_{};
    LossCause last_ = LossCause::latency;
    std::uint32_t preemptions_ = 0;
};

} // namespace quiesced

#endif
