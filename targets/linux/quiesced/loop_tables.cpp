#include "loop_tables.h"

#include <algorithm>

#include "clock.h"
#include "names.h"

namespace quiesced {

namespace {

constexpr int kLastAttempts = 1000; // a millisecond apart

std::uint32_t crc_in(const std::uint32_t *table) {
    return table != nullptr ? table[1] : 0;
}

table_found_t found_of(std::uint32_t road, table_source_t source, const TableWords &words,
                       std::uint32_t writes) {
    return {record_of(road), source, words.data(), static_cast<std::uint32_t>(words.size()),
            writes};
}

} // namespace

keeper_answer_t LoopTables::store(void *self, keeper_record_t record, const std::uint32_t *words,
                                  std::uint32_t count) {
    auto &tables = *static_cast<LoopTables *>(self);
    Words &of = tables.order_.of;
    if (count > of.words.size()) {
        return KEEPER_FAILED;
    }
    tables.order_.record = record;
    of.count = count;
    std::copy_n(words, count, of.words.begin());
    if (!tables.exchange_.to_store.put(tables.order_)) {
        return KEEPER_BUSY;
    }
    tables.exchange_.wake();
    return KEEPER_BEGUN;
}

void LoopTables::answer() {
    const StoreResult result = exchange_.store_result.exchange(StoreResult::none);
    if (result != StoreResult::none) {
        node_stored(&node_, result == StoreResult::stored);
    }
}

// At the start

/// Returns false, after a line, iff it is refused.
bool LoopTables::use_found(const table_found_t &found) {
    const quiesce_table_verdict_t verdict = node_found(&node_, &found);
    if (verdict != QUIESCE_TABLE_OK) {
        const std::uint32_t road = road_of(found.record);
        exchange_.log.log(LogLevel::warning, "%s (%s) is refused: %s", road_name(road),
                          table_source_name(found.source),
                          road == ROAD_LEARNT ? "it belongs to another law, table or setting"
                                              : verdict_text(verdict));
    }
    return verdict == QUIESCE_TABLE_OK && found.count > 0;
}

void LoopTables::use_road(std::uint32_t road, const StartTables &start) {
    const StoredTable &stored = start.stored[road];
    keeper_found_as(&node_.tables.keeper, record_of(road), stored.state);
    const bool is_used = use_found(found_of(road, TABLE_FROM_STORE, stored.words, stored.writes));
    if (road == ROAD_LEARNT) {
        if (is_used) {
            exchange_.log.log(LogLevel::info, "what was learnt before is used");
        }
    } else if (!is_used && !start.configured[road].empty()) {
        use_configured(static_cast<quiesce_owner_t>(road), start.configured[road]);
    }
}

/// It takes the place of a stored one that would wait for other parameters.
void LoopTables::use_configured(quiesce_owner_t owner, const TableWords &words) {
    const bool has_waited = is_waiting(owner);
    if (use_found(found_of(owner, TABLE_FROM_CONFIG, words, 0)) && has_waited) {
        exchange_.log.log(LogLevel::info,
                          "%s (stored) can be used again: apply and save the parameters that it "
                          "was made for, then restart",
                          road_name(owner));
    }
}

void LoopTables::use(const StartTables &start) {
    for (const quiesce_owner_t owner : kOwners) {
        told_crc_[owner] = crc_in(quiesce_table_in_use(&node_.controller, owner));
    }
    for (std::uint32_t road = 0; road < ROADS; ++road) { // what was learnt is of a table
        use_road(road, start);
    }
    tell();
}

// While it runs

/// A law of the same reading of the configuration comes before its table.
void LoopTables::take_new(quiesce_owner_t owner) {
    Mailbox<Words> &box = exchange_.new_tables[owner];
    const Words *table = box.look();
    if (table == nullptr || exchange_.new_params.is_full()) {
        return;
    }
    quiesce_table_verdict_t verdict = QUIESCE_TABLE_OK;
    const table_found_t found = {record_of(owner), TABLE_FROM_CONFIG, table->words.data(),
                                 table->count, 0};
    if (table->count == 0) {
        (void)quiesce_tables_unload(&node_.tables.tables, &node_.controller, owner);
    } else if (!node_offer(&node_, &found, &verdict)) {
        return;
    }
    if (verdict != QUIESCE_TABLE_OK) {
        exchange_.log.log(LogLevel::error, "%s stays: the configuration's is refused: %s",
                          road_name(owner), verdict_text(verdict));
    }
    box.drop();
    exchange_.wake();
}

void LoopTables::take() {
    answer();
    for (const quiesce_owner_t owner : kOwners) {
        take_new(owner);
    }
}

table_source_t LoopTables::source_of(std::uint32_t road) const {
    const auto owner = static_cast<quiesce_owner_t>(road);
    const bool is_loaded = road == ROAD_LEARNT ||
                           quiesce_tables_is_loaded(&node_.tables.tables, &node_.controller, owner);
    return is_loaded ? node_.tables.of[road].source : TABLE_SHIPS;
}

bool LoopTables::is_waiting(quiesce_owner_t owner) const {
    return quiesce_tables_is_waiting(&node_.tables.tables, &node_.controller, owner);
}

void LoopTables::tell_waiting(quiesce_owner_t owner) {
    const bool waits = is_waiting(owner);
    if (waits && !told_waiting_[owner]) {
        exchange_.log.log(LogLevel::info,
                          "%s (%s) waits: it is used once the parameters that it was made for are "
                          "applied",
                          road_name(owner), table_source_name(node_.tables.of[owner].source));
    }
    told_waiting_[owner] = waits;
}

void LoopTables::tell() {
    for (const quiesce_owner_t owner : kOwners) {
        tell_waiting(owner);
        const std::uint32_t *table = quiesce_table_in_use(&node_.controller, owner);
        if (crc_in(table) != told_crc_[owner]) {
            told_crc_[owner] = crc_in(table);
            exchange_.log.log(
                LogLevel::info, "%s: %s, CRC %08x (%s)", road_name(owner),
                table != nullptr ? quiesce_table_kind(table[0], nullptr) : "none",
                static_cast<unsigned>(told_crc_[owner]),
                table_source_name(table != nullptr ? source_of(owner) : TABLE_FROM_NOWHERE));
        }
    }
    const char *lacking = quiesce_lacks_table(&node_.controller);
    if (lacking != told_lacking_ && lacking != nullptr) {
        exchange_.log.log(LogLevel::warning,
                          "%s has no table: it requests nothing until one is loaded", lacking);
    }
    told_lacking_ = lacking;
}

std::array<RoadStatus, ROADS> LoopTables::status() const {
    std::array<RoadStatus, ROADS> roads{};
    learnt_t learnt;
    const bool learns = learnt_take(&learnt, &node_.controller);
    for (std::uint32_t road = 0; road < ROADS; ++road) {
        const std::uint32_t *words =
            road != ROAD_LEARNT
                ? quiesce_table_in_use(&node_.controller, static_cast<quiesce_owner_t>(road))
                : (learns ? learnt.words : nullptr);
        const auto &kept = node_.tables.keeper.kept[record_of(road)];
        roads[road] = {words != nullptr ? words[0] : 0,
                       crc_in(words),
                       words != nullptr ? source_of(road) : TABLE_FROM_NOWHERE,
                       kept.mark,
                       kept.writes,
                       node_.tables.of[road].refusal,
                       kept.state};
    }
    return roads;
}

// At the end

void LoopTables::store_last() {
    keeper_t &keeper = node_.tables.keeper;
    learnt_t learnt;
    if (!learnt_take(&learnt, &node_.controller)) {
        return;
    }
    for (int i = 0;
         i < kLastAttempts && keeper.kept[KEEPER_LEARNT].mark != learnt_crc(&learnt) &&
         !keeper_begin(&keeper, KEEPER_LEARNT, learnt_crc(&learnt), learnt.words, learnt.words[2]);
         ++i) {
        sleep_ms(1);
        answer();
    }
}

} // namespace quiesced
