/// The configuration read again while the controller runs (SIGHUP): its parameters and tables go to
/// the loop, all of them or none.
#ifndef QUIESCED_RELOAD_H
#define QUIESCED_RELOAD_H

#include "exchange.h"
#include "log_sink.h"
#include "start_tables.h"
#include "state_store.h"

namespace quiesced {

class Reload {
  public:
    /// tables: of the start. Everything else that it is given must outlive it.
    Reload(const Config &config, const StateStore &store, const ConfiguredTables &tables,
           Exchange &exchange, LogSink &sink)
        : config_(config), store_(store), exchange_(exchange), sink_(sink), params_(config.params),
          tables_(tables) {}

    /// Reads the file. A mistake leaves all as it is, after a line.
    void begin();

    /// Tells the service manager once the loop has taken what was read.
    void finish();

    /// What [parameters] says, as it was read last.
    const quiesce_params_t &params() const { return params_; }
    /// Likewise of [tables].
    const ConfiguredTables &tables() const { return tables_; }

  private:
    void read();
    bool is_taken() const;
    ConfiguredTables changed_of(ConfiguredTables tables) const;
    void hand_over(const quiesce_params_t &params, const ConfiguredTables &tables);

    const Config &config_;
    const StateStore &store_;
    Exchange &exchange_;
    LogSink &sink_;
    quiesce_params_t params_;
    ConfiguredTables tables_;
    bool is_under_way_ = false;
};

} // namespace quiesced

#endif
