/// The thread beside the control loop: it has normal priority and does all that may wait, the log,
/// the state folder, the service manager, signals, new parameters, devices that are gone.
#ifndef QUIESCED_SERVICE_H
#define QUIESCED_SERVICE_H

#include <optional>
#include <string>
#include <thread>

#include "caretaker.h"
#include "exchange.h"
#include "fault_store.h"
#include "kept_config.h"
#include "log_sink.h"
#include "record_store.h"
#include "reload.h"

namespace quiesced {

/// Something that fails again and again: told when that starts and when it ends.
class Trouble {
  public:
    explicit Trouble(const char *name) : name_(name) {}
    /// error: of this attempt, empty where it went well.
    void note(const std::string &error, LogSink &sink);

  private:
    const char *name_;
    std::uint32_t failures_ = 0;
};

/// What outlives the program beyond what the thread makes itself: a fault, its record, and the
/// process that acts where this one is killed.
struct Survivors {
    FaultStore &faults;
    RecordStore &records;
    Caretaker &caretaker;
};

class Service {
  public:
    /// Starts the thread. Make it before the calling thread becomes a real-time thread. tables: of
    /// the start. Everything else that it is given must outlive it.
    Service(const Config &config, const ConfiguredTables &tables, Exchange &exchange,
            const Survivors &survivors, LogSink &sink);
    Service(const Service &) = delete;
    Service &operator=(const Service &) = delete;

    /// Says that the loop has ended, and waits until everything is written.
    ~Service();

  private:
    void run();
    void wait();
    void work(std::int64_t now_ns);
    void drain_log();
    void look_after_devices();
    void write_files();
    void store_words();
    std::string store(const StoreOrder &order);
    void store_fault(std::int64_t now_ns);
    void store_record(std::int64_t now_ns);
    void keep_params();
    void tell_manager();
    void say_last_words();

    const Config &config_;
    Exchange &exchange_;
    LogSink &sink_;
    StateStore store_;
    TableStore tables_;
    FaultStore &faults_;
    RecordStore &records_;
    Caretaker &caretaker_;
    KeptConfig kept_;
    const Notifier &manager_;
    Reload reload_;

    Snapshot last_{};
    std::uint32_t stored_fault_; ///< as on the disk
    Trouble status_trouble_{"status file"};
    Trouble fault_trouble_{"latched fault"};
    Trouble record_trouble_{"fault record"};
    Trouble params_trouble_{"parameters for --make-safe"};
    std::uint32_t told_dropped_ = 0;
    std::int64_t next_status_ns_ = 0;
    std::int64_t next_fault_ns_ = 0;   ///< after a failure
    std::int64_t next_record_ns_ = 0;  ///< likewise
    std::optional<KeptRecord> record_; ///< not on the disk yet
    std::int64_t next_devices_ns_ = 0;
    bool is_ready_ = false;
    bool is_stopping_ = false;
    std::thread thread_;
};

} // namespace quiesced

#endif
