/// Everything that the control loop and the thread beside it (service.h) say to each other.
#ifndef QUIESCED_EXCHANGE_H
#define QUIESCED_EXCHANGE_H

#include <array>
#include <atomic>
#include <cstdint>

#include "devices.h"
#include "log_ring.h"
#include "lost_ticks.h"
#include "mailbox.h"
#include "notify.h"
#include "record_store.h"
#include "replaceable.h"

namespace quiesced {

/// A fault that was entered, once or more; when it was last.
struct FaultEvent {
    std::uint32_t fault; ///< QUIESCE_FAULT_NONE: no such event
    std::uint32_t tick;
    std::int64_t time_ns; ///< CLOCK_REALTIME
    std::uint32_t times;  ///< since the start, saturating
};

/// A table, or what was learnt, for the status file.
struct RoadStatus {
    std::uint32_t magic; ///< of what is in use, 0: nothing is
    std::uint32_t crc;
    std::uint32_t source; ///< table_source_t
    std::uint32_t stored_crc;
    std::uint32_t writes;
    quiesce_table_verdict_t refusal; ///< of the last attempt
    keeper_state_t record;
};

/// What the status file shows, taken at the end of a tick.
struct Snapshot {
    static constexpr std::size_t kFaults = 8;

    quiesce_telemetry_t telemetry;
    std::array<quiesce_sample_t, QUIESCE_SENSORS> sensors; ///< the last ones had
    std::array<quiesce_driver_t, QUIESCE_DAMPERS> drivers;
    std::array<quiesce_command_t, QUIESCE_DAMPERS> commands;
    bool is_driver_enabled;
    bool is_enabled;          ///< the operator's enable, from wherever it comes
    bool is_estop;            ///< likewise
    std::uint32_t kept_fault; ///< of an earlier run, not acknowledged yet
    std::uint32_t param_hash;
    hal_tick_t timing;
    LossCounts lost;
    bool has_priority; ///< of real time
    std::uint64_t ticks;
    can_bus_state_t bus_state;
    can_bus_counters_t bus;
    std::uint32_t tx_shed; ///< of bus.tx_dropped: telemetry, and what newer frames replaced
    can_node_counters_t node;
    std::array<RoadStatus, ROADS> roads;
    std::array<FaultEvent, kFaults> faults; ///< the newest first
    std::uint32_t log_dropped;
};

/// Lines and drivers that may vanish.
struct Peripherals {
    std::array<Replaceable<std::unique_ptr<SensorDevice>>, QUIESCE_SENSORS> sensors;
    std::array<Replaceable<std::unique_ptr<CurrentDevice>>, QUIESCE_DAMPERS> outputs;
    Replaceable<Line> enable_output;
    Replaceable<Line> fault_output;
    Replaceable<Line> estop_input;
    Replaceable<std::unique_ptr<EnableInput>> enable_input;
    Replaceable<Line> data_ready_input;
};

/// Words on their way from one thread to the other.
struct Words {
    std::uint32_t count;
    std::array<std::uint32_t, QUIESCE_TABLE_WORDS> words;
};

/// A record that is to be stored; of 0 words: forgotten.
struct StoreOrder {
    keeper_record_t record;
    Words of;
};

/// How that went.
enum class StoreResult : int { none, stored, failed };

struct Exchange {
    Exchange();
    Exchange(const Exchange &) = delete;
    Exchange &operator=(const Exchange &) = delete;
    ~Exchange();

    /// From the loop, where the other thread has something to do at once.
    void wake() const;

    LogRing log;
    const Notifier manager; ///< of services; for both
    Peripherals peripherals;
    std::atomic<std::uint64_t> ticks{0}; ///< done since the start
    std::atomic<bool> loop_has_ended{false};

    // To the other thread.
    Mailbox<Snapshot> snapshot;
    Mailbox<StoreOrder> to_store;
    Mailbox<KeptRecord> record;          ///< after each change of it
    Mailbox<quiesce_params_t> in_effect; ///< after each restart with others
    /// To be kept until it is acknowledged, QUIESCE_FAULT_NONE: nothing; before the start: what an
    /// earlier run left. In memory that a process shares which is started from here.
    std::atomic<std::uint32_t> &latched_fault;

    // To the loop.
    std::atomic<bool> snapshot_is_wanted{false};
    std::atomic<StoreResult> store_result{StoreResult::none};
    Mailbox<quiesce_params_t> new_params;
    /// By quiesce_owner_t; of 0 words: back to the one that ships. After new_params, where both are
    /// put.
    std::array<Mailbox<Words>, QUIESCE_TABLE_OWNERS> new_tables;

    /// The loop's, or null. The other thread calls nothing but can_bus_recover. Set it before both
    /// start.
    can_bus_t *bus = nullptr;

    int wake_fd; ///< an eventfd
};

} // namespace quiesced

#endif
