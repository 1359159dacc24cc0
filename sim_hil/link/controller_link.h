/// A controller that the bench drives in lock-step, wherever it runs.
#ifndef QUIESCE_CONTROLLER_LINK_H
#define QUIESCE_CONTROLLER_LINK_H

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware.h"

namespace quiesce {

/// Instructions that the target executed for each control tick, exactly counted.
struct InstructionCounts {
    std::uint64_t ticks;
    std::uint64_t median;
    std::uint64_t worst;
    std::uint64_t total;      ///< of all ticks
    std::uint64_t worst_tick; ///< the first of the worst, from 1
};

/// One bit for each 32-bit word of lockstep_reply_t, in memory order.
using ReplyWords = std::bitset<sizeof(lockstep_reply_t) / sizeof(std::uint32_t)>;

/// Words of the law's table and of its tracker's, by LOCKSTEP_x_TABLE; empty where there is none.
using Tables = std::array<std::vector<std::uint32_t>, LOCKSTEP_TABLES>;

/// What a controller says to its start.
struct StartAnswer {
    bool is_accepted;
    lockstep_refusal_t table{}; ///< that it refuses; where none, parameters or board are refused
    std::optional<std::uint32_t> param{}; ///< index of the one that it refuses, where it says so

    explicit operator bool() const { return is_accepted; }
};

/// One stimulus in, one control tick, one reply out. Not thread-safe.
/// Every function throws InputError when the target cannot be reached or stops answering.
class ControllerLink {
  public:
    virtual ~ControllerLink() = default;

    /// Name of the target, as --target takes it.
    virtual std::string target() const = 0;

    /// (Re)starts the controller from rest. board: what is wired to it; null: as the parameters
    /// say. tables: instead of those that ship. Where one of them is refused the controller stays
    /// in its latched fault state and still answers. May be called again for a new run.
    virtual StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                              const Tables &tables) = 0;

    /// One control tick. Writes all of reply, 0 where nothing was asked for. Only after start.
    virtual void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) = 0;

    /// What has come since the last exchange from a target that does not wait for one: changes
    /// reply. Once before each exchange, or never.
    virtual void look(lockstep_reply_t &reply) { (void)reply; }

    /// False iff a reply may hold words that are older than its tick.
    virtual bool is_complete() const { return true; }

    /// False iff a picture that is asked for stays 0.
    virtual bool has_picture() const { return true; }

    /// Words of the reply that the last exchange brought from the target; the others are what it
    /// sent last, or 0. All of them unless the link says otherwise.
    virtual ReplyWords received() const { return ReplyWords().set(); }

    /// Ends the target. Returns its instruction counts iff it was started with a way to count them.
    /// Call it at most once, as the last call.
    virtual std::optional<InstructionCounts> finish() = 0;
};

} // namespace quiesce

#endif
