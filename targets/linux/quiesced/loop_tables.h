/// The control loop's part of tables, of what was learnt, and of what else is to outlive the
/// program: uses what the start and the configuration have, hands records to the other thread.
#ifndef QUIESCED_LOOP_TABLES_H
#define QUIESCED_LOOP_TABLES_H

#include "exchange.h"
#include "start_tables.h"

namespace quiesced {

class LoopTables {
  public:
    LoopTables(node_t &node, Exchange &exchange) : node_(node), exchange_(exchange) {}
    LoopTables(const LoopTables &) = delete;
    LoopTables &operator=(const LoopTables &) = delete;

    /// After node_init: records go to the other thread.
    void connect() { node_use_store(&node_, store, this); }
    /// Then, before the first tick: what is there is used where the controller takes it.
    void use(const StartTables &start);

    /// At the start of a tick, after new parameters have been taken.
    void take();
    /// At its end: what has changed is logged.
    void tell();
    /// After the last one: what was learnt is stored once more. Waits for the other thread.
    void store_last();

    std::array<RoadStatus, ROADS> status() const;

  private:
    static keeper_answer_t store(void *self, keeper_record_t record, const std::uint32_t *words,
                                 std::uint32_t count);
    void answer();
    void take_new(quiesce_owner_t owner);
    void use_road(std::uint32_t road, const StartTables &start);
    void use_configured(quiesce_owner_t owner, const TableWords &words);
    bool use_found(const table_found_t &found);
    bool is_waiting(quiesce_owner_t owner) const;
    void tell_waiting(quiesce_owner_t owner);
    table_source_t source_of(std::uint32_t road) const;

    node_t &node_;
    Exchange &exchange_;
    StoreOrder order_{};
    std::array<std::uint32_t, QUIESCE_TABLE_OWNERS> told_crc_{};
    std::array<bool, QUIESCE_TABLE_OWNERS> told_waiting_{};
    const char *told_lacking_ = nullptr;
};

} // namespace quiesced

#endif
