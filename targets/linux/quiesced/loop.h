/// The control loop: everything that happens in a tick. Nothing in it allocates, waits for a disk
/// or for another thread.
#ifndef QUIESCED_LOOP_H
#define QUIESCED_LOOP_H

#include <algorithm>
#include <optional>

#include "board.h"
#include "bus.h"
#include "change_log.h"
#include "fault_latch.h"
#include "frame_sender.h"
#include "loop_tables.h"
#include "tick_source.h"

namespace quiesced {

class Loop {
  public:
    /// Starts the controller from rest: the drivers get their safe currents. Where
    /// exchange.latched_fault has a fault, they stay off until it is acknowledged. exchange
    /// and its peripherals, source, bus and watchdog (null: none) must outlive the loop.
    Loop(const Config &config, const quiesce_params_t &params, Exchange &exchange,
         TickSource &source, can_bus_t *bus, watchdog_t *watchdog);
    Loop(const Loop &) = delete;
    Loop &operator=(const Loop &) = delete;

    /// Puts back tables and what was learnt, before the first tick.
    void use_tables(const StartTables &start) { tables_.use(start); }

    /// Puts back the fault record of an earlier run. Returns false iff it is none of this version.
    bool use_record(const KeptRecord &record);

    /// Runs until a stop is requested or, where ticks is not 0, for so many ticks; then safe
    /// current, output off, lines inactive, farewell on the bus.
    void run(std::uint64_t ticks);

  private:
    static constexpr std::uint32_t kRefreshes_Hz = 20;

    void tick(std::uint32_t elapsed);
    void count_lost(std::uint32_t elapsed);
    void receive();
    void write_current(std::size_t damper, std::int32_t current_mA, bool enable);
    void write_commands();
    void write_safe(const quiesce_params_t &params);
    void use_axes(bool is_accepted);
    void restart(const quiesce_params_t &params);
    void take_new_params();
    void use_live(const quiesce_params_t &params);
    void use_params(const quiesce_params_t &params);
    void prepare_apply();
    void after_change();
    void after_restart();
    void send();
    void report(std::int64_t now_ns);
    Snapshot snapshot() const;
    void put_snapshot();
    void put_params();
    void leave();
    bool say_farewell();
    bool put_record();
    void put_last();

    bool is_safe_command() const;
    bool is_due_each_second() const { return exchange_.ticks.load() % rate_Hz_ == 0; }
    /// Of an output that has not changed: every 50 ms.
    bool is_refresh_due() const {
        return exchange_.ticks.load() % std::max(1U, rate_Hz_ / kRefreshes_Hz) == 0;
    }

    const Config &config_;
    Exchange &exchange_;
    LogRing &log_;
    can_bus_t *bus_;

    node_t node_{};
    Axes axes_{};
    LoopTables tables_;
    FaultLatch latch_;
    Board board_;
    TickSource &source_;
    ChangeLog changes_;
    FrameSender sender_;
    LostTicks lost_;

    std::uint32_t rate_Hz_ = 0;
    std::uint32_t restarts_ = 0;
    std::uint32_t retunes_ = 0;
    bool has_new_params_ = false;         ///< that the other thread does not know yet
    std::uint32_t record_generation_ = 0; ///< that the other thread has
};

} // namespace quiesced

#endif
