// Tables from files and from earlier runs, on their way into the loop and out of it.
#include <gtest/gtest.h>

#include <csignal>
#include <memory>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "board_file.h"
#include "input_error.h"
#include "loop_tables.h"
#include "names.h"
#include "status_file.h"
#include "table_files.h"
#include "temporary_folder.h"
#include "two_storeys.h"

namespace quiesced {
namespace {

using quiesce::file_bytes;
using quiesce::with_crc;

quiesce_params_t params_of(std::int32_t law) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    params.law = law;
    return params;
}

/// Those that a law ships with.
TableWords shipped(std::int32_t law) {
    const quiesce_params_t params = params_of(law);
    const auto controller = std::make_unique<quiesce_t>();
    EXPECT_TRUE(quiesce_init(controller.get(), &params));
    const std::uint32_t *words = quiesce_table_in_use(controller.get(), QUIESCE_OF_LAW);
    return {words, words + words[2]};
}

/// Good rules that are a little other than those that ship.
TableWords rules(std::uint32_t number) {
    TableWords words = shipped(QUIESCE_LAW_FUZZY);
    for (std::size_t at = words.size() - 1; number > 0; --at) {
        TableWords other = words;
        other[at] ^= 1U;
        other = with_crc(other);
        if (quiesce_table_check(other.data(), static_cast<std::uint32_t>(other.size())) ==
            QUIESCE_TABLE_OK) {
            words = other;
            --number;
        }
    }
    return words;
}

/// A damper's: of one section, over stroke velocity, 2 places and 2 currents.
TableWords damper_map() {
    constexpr auto minus = [](std::uint32_t value) { return 0U - value; };
    return with_crc({0x32464D51, 0, 15, 1, 4, 2, 2, minus(1000), 1000, 0, 1500, minus(20000),
                     minus(500000), 20000, 500000});
}

// ---- files --------------------------------------------------------------------------------------

class TableFile : public testing::Test {
  protected:
    TableFile() { config.params = params_of(QUIESCE_LAW_FUZZY); }

    void put(quiesce_owner_t owner, const std::string &bytes) {
        config.tables[owner] = folder / (std::string(owner_name(owner)) + ".table");
        write_text(config.tables[owner], bytes);
    }

    /// What is wrong, without the folder; "": nothing.
    std::string wrong(const quiesce_board_t *board = nullptr) {
        try {
            require_fit(load_tables(config, board), config, board, config.params);
            return "";
        } catch (const quiesce::InputError &error) {
            std::string line = error.what();
            EXPECT_EQ(line.find('\n'), std::string::npos);
            const std::size_t at = line.find(folder.path());
            return at == std::string::npos ? line : line.erase(at, folder.path().size() + 1);
        }
    }

    TemporaryFolder folder;
    Config config;
};

TEST_F(TableFile, of_the_law_that_runs_is_loaded) {
    EXPECT_EQ(load_table(config, QUIESCE_OF_LAW, nullptr), TableWords());
    put(QUIESCE_OF_LAW, file_bytes(rules(1)));
    EXPECT_EQ(wrong(), "");
    EXPECT_EQ(load_table(config, QUIESCE_OF_LAW, nullptr), rules(1));
}

TEST_F(TableFile, that_is_no_good_one_is_told_in_a_line) {
    config.tables[QUIESCE_OF_LAW] = folder / "none.table";
    EXPECT_EQ(wrong(), "tables.law: none.table: cannot be read; name a table file");
    put(QUIESCE_OF_LAW, "DAMPER\n");
    EXPECT_EQ(wrong().rfind("tables.law: law.table: not a table file", 0), 0U) << wrong();
    std::string bytes = file_bytes(rules(1));
    bytes[40] = static_cast<char>(bytes[40] ^ 1);
    put(QUIESCE_OF_LAW, bytes);
    EXPECT_EQ(wrong(), "tables.law: law.table: its checksum is wrong: it is damaged");
    put(QUIESCE_OF_LAW, file_bytes(TableWords{0x12345678, 0, 4, 0}));
    EXPECT_EQ(wrong().rfind("tables.law: law.table: not a table that this law", 0), 0U) << wrong();
}

TEST_F(TableFile, of_another_owner_is_sent_to_its_key) {
    put(QUIESCE_OF_LAW, file_bytes(damper_map()));
    EXPECT_EQ(wrong(), "tables.law: law.table: a table of kind map is for tables.tracker");
}

TEST_F(TableFile, of_another_law_does_not_fit) {
    put(QUIESCE_OF_LAW, file_bytes(shipped(QUIESCE_LAW_PHASE)));
    EXPECT_EQ(wrong().rfind("tables.law: law.table: not a table that this law", 0), 0U) << wrong();
}

TEST_F(TableFile, of_another_board_is_refused_by_its_stamp) {
    const TwoStoreys rig;
    const quiesce::BoardFile board = quiesce::load_board(rig.folder / "rig.board.toml");
    const std::uint32_t own = table_file_board(&board.board);
    put(QUIESCE_OF_LAW, file_bytes(rules(1), own));
    EXPECT_EQ(wrong(&board.board), "");
    EXPECT_NE(wrong().find(", and this is no board; make it anew"), std::string::npos) << wrong();
    put(QUIESCE_OF_LAW, file_bytes(rules(1), own ^ 1U));
    EXPECT_EQ(wrong(&board.board).rfind("tables.law: law.table: made for board 0x", 0), 0U);
}

// ---- records ------------------------------------------------------------------------------------

const StoredOver kOver = {17, 4};

std::string save(const TemporaryFolder &folder, keeper_record_t record, const StoredOver &over,
                 const TableWords &words) {
    return TableStore(folder.path())
        .save(record, over, words.data(), static_cast<std::uint32_t>(words.size()));
}

TEST(TableStore, counts_its_writes_and_gives_back_the_last) {
    const TemporaryFolder folder;
    const TableStore store(folder.path());
    std::string note = "x";
    EXPECT_TRUE(store.load(KEEPER_LAW_TABLE, kOver, note).words.empty());
    EXPECT_EQ(note, "");
    for (std::uint32_t i = 1; i < 5; ++i) {
        ASSERT_EQ(save(folder, KEEPER_LAW_TABLE, kOver, TableWords(3 + i, i)), "");
        const StoredTable found = store.load(KEEPER_LAW_TABLE, kOver, note);
        EXPECT_EQ(found.words, TableWords(3 + i, i));
        EXPECT_EQ(found.writes, i);
        EXPECT_EQ(note, "");
    }
    EXPECT_TRUE(store.load(KEEPER_TRACKER_TABLE, kOver, note).words.empty());
    ASSERT_EQ(save(folder, KEEPER_LAW_TABLE, kOver, {}), ""); // forgotten
    EXPECT_TRUE(store.load(KEEPER_LAW_TABLE, kOver, note).words.empty());
    EXPECT_EQ(store.load(KEEPER_LAW_TABLE, kOver, note).writes, 5U);
    EXPECT_EQ(store.load(KEEPER_LAW_TABLE, {18, 4}, note).writes, 5U);
    EXPECT_EQ(note, "");
}

TEST(TableStore, takes_the_largest_table_and_no_larger_one) {
    const TemporaryFolder folder;
    std::string note;
    const TableWords most(QUIESCE_TABLE_WORDS, 7);
    ASSERT_EQ(save(folder, KEEPER_TRACKER_TABLE, kOver, most), "");
    EXPECT_EQ(TableStore(folder.path()).load(KEEPER_TRACKER_TABLE, kOver, note).words, most);
    EXPECT_NE(save(folder, KEEPER_TRACKER_TABLE, kOver, TableWords(QUIESCE_TABLE_WORDS + 1)), "");
    EXPECT_NE(save(folder, KEEPER_LEARNT, {}, TableWords(LEARNT_MOST_WORDS + 1)), "");
    EXPECT_EQ(TableStore(folder.path()).load(KEEPER_TRACKER_TABLE, kOver, note).words, most);
}

TEST(TableStore, who_edits_configuration_or_board_means_it) {
    const TemporaryFolder folder;
    const TableStore store(folder.path());
    std::string note;
    ASSERT_EQ(save(folder, KEEPER_LAW_TABLE, kOver, {1, 2, 3, 4}), "");
    EXPECT_TRUE(store.load(KEEPER_LAW_TABLE, {18, 4}, note).words.empty());
    EXPECT_EQ(note, "the law's table as stored is not used: [tables] has changed since");
    EXPECT_TRUE(store.load(KEEPER_LAW_TABLE, {17, 5}, note).words.empty());
    EXPECT_EQ(note, "the law's table as stored is not used: the board has changed since");
    EXPECT_EQ(store.load(KEEPER_LAW_TABLE, {17, 5}, note).writes, 1U);
    ASSERT_EQ(save(folder, KEEPER_LEARNT, {}, {1, 2, 3, 4}), ""); // knows what it belongs to
    EXPECT_EQ(store.load(KEEPER_LEARNT, kOver, note).words.size(), 4U);
}

/// Of each record: what a cut or a flipped bit leaves.
class DamagedRecord : public testing::TestWithParam<keeper_record_t> {
  protected:
    StoredTable load() { return store.load(GetParam(), kOver, note); }
    std::string save(const TableWords &words) {
        return quiesced::save(folder, GetParam(), kOver, words);
    }

    void expect_lost(const std::string &content) {
        write_text(file, content);
        const StoredTable found = load();
        EXPECT_TRUE(found.words.empty());
        EXPECT_EQ(found.state, KEEPER_LOST);
        EXPECT_NE(note.find(" is not used: "), std::string::npos) << note;
        EXPECT_EQ(note.rfind(road_name(road_of(GetParam())), 0), 0U) << note;
        EXPECT_EQ(read_text(file), content); // it is left where it is
    }

    TemporaryFolder folder;
    TableStore store{folder.path()};
    std::string file = store.file(GetParam());
    std::string note;
};

TEST_P(DamagedRecord, is_told_and_written_anew) {
    ASSERT_EQ(save({1, 2, 3, 4}), "");
    const std::string whole = read_text(file);
    for (std::size_t at = 0; at < whole.size(); at += at < 80 ? 1 : 997) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 4);
        expect_lost(damaged);
        expect_lost(whole.substr(0, at));
    }
    ASSERT_EQ(save({5, 6, 7, 8}), "");
    EXPECT_EQ(load().words.front(), 5U);
    EXPECT_EQ(load().state, KEEPER_WHOLE);
    EXPECT_NE(TableStore("/no/such/folder").save(GetParam(), kOver, nullptr, 0), "");
}

TEST_P(DamagedRecord, half_of_a_new_one_beside_it_does_no_harm) {
    ASSERT_EQ(save({1, 2, 3, 4}), "");
    const std::string whole = read_text(file);
    for (std::size_t bytes = 0; bytes <= whole.size(); bytes += 97) {
        write_text(file + ".new", whole.substr(0, bytes));
        EXPECT_EQ(load().words, TableWords({1, 2, 3, 4}));
        EXPECT_EQ(note, "");
    }
    ASSERT_EQ(save({5, 6, 7, 8}), "");
    EXPECT_EQ(load().words.front(), 5U);
    EXPECT_EQ(load().writes, 2U);
}

/// A child that stores other words again and again until it is killed; tells of each.
pid_t start_writer(int tell_fd, const TemporaryFolder &folder, keeper_record_t record) {
    const pid_t child = fork();
    if (child != 0) {
        return child;
    }
    for (std::uint32_t i = 1;; ++i) {
        if (!save(folder, record, kOver, TableWords(200, i)).empty() ||
            write(tell_fd, &i, sizeof i) != sizeof i) {
            _exit(1);
        }
    }
}

TEST_P(DamagedRecord, is_none_after_a_kill_at_any_moment) {
    for (int round = 0; round < 20; ++round) {
        std::array<int, 2> told{};
        ASSERT_EQ(pipe2(told.data(), O_CLOEXEC), 0);
        const pid_t child = start_writer(told[1], folder, GetParam());
        ASSERT_GT(child, 0);
        close(told[1]);
        std::uint32_t last = 0;
        for (int i = 0; i <= round % 4; ++i) {
            ASSERT_EQ(read(told[0], &last, sizeof last), static_cast<ssize_t>(sizeof last));
        }
        ASSERT_EQ(kill(child, SIGKILL), 0);
        ASSERT_EQ(waitpid(child, nullptr, 0), child);
        while (read(told[0], &last, sizeof last) == static_cast<ssize_t>(sizeof last)) {
        }
        close(told[0]);
        const StoredTable found = load();
        ASSERT_EQ(found.words.size(), 200U) << note;
        EXPECT_EQ(found.words, TableWords(200, found.words.front()));
        EXPECT_GE(found.words.front(), last); // what it told of is there, or the next
        EXPECT_LE(found.words.front(), last + 1);
        EXPECT_EQ(note, "");
    }
}

INSTANTIATE_TEST_SUITE_P(, DamagedRecord,
                         testing::Values(KEEPER_LAW_TABLE, KEEPER_TRACKER_TABLE, KEEPER_LEARNT));

// ---- in the loop --------------------------------------------------------------------------------

constexpr int kTicks = 200; // more than the largest table is summed in

class InTheLoop : public testing::Test {
  protected:
    explicit InTheLoop(std::int32_t law = QUIESCE_LAW_FUZZY) { init(law); }

    void init(std::int32_t law) {
        const quiesce_params_t params = params_of(law);
        ASSERT_TRUE(node_init(node.get(), nullptr, &params, {NODE_ENABLE_BOARD, 0}));
        tables = std::make_unique<LoopTables>(*node, *exchange);
        tables->connect();
    }

    std::uint32_t in_use(quiesce_owner_t owner = QUIESCE_OF_LAW) {
        const std::uint32_t *words = quiesce_table_in_use(&node->controller, owner);
        return words != nullptr ? words[1] : 0;
    }

    std::string log() {
        std::string all;
        LogLine line{};
        while (exchange->log.take(line)) {
            all += std::string(line.text.data()) + "\n";
        }
        return all;
    }

    void offer(const TableWords &words) {
        Words box{static_cast<std::uint32_t>(words.size()), {}};
        std::copy(words.begin(), words.end(), box.words.begin());
        ASSERT_TRUE(exchange->new_tables[QUIESCE_OF_LAW].put(box));
    }

    int ticks_until_taken() {
        int ticks = 0;
        for (; ticks < kTicks && exchange->new_tables[QUIESCE_OF_LAW].is_full(); ++ticks) {
            tables->take();
            tables->tell();
        }
        return ticks;
    }

    std::unique_ptr<Exchange> exchange = std::make_unique<Exchange>();
    std::unique_ptr<node_t> node = std::make_unique<node_t>();
    std::unique_ptr<LoopTables> tables;
    StartTables start;
};

TEST_F(InTheLoop, a_stored_table_comes_before_the_configurations) {
    start.stored[ROAD_LAW] = {rules(1), 3};
    start.configured[QUIESCE_OF_LAW] = rules(2);
    tables->use(start);
    EXPECT_EQ(in_use(), rules(1)[1]);
    EXPECT_NE(log().find("(stored)"), std::string::npos);
    const RoadStatus status = tables->status()[ROAD_LAW];
    EXPECT_EQ(status.crc, rules(1)[1]);
    EXPECT_EQ(status.stored_crc, rules(1)[1]);
    EXPECT_EQ(status.writes, 3U);
    EXPECT_EQ(status.source, TABLE_FROM_STORE);
    EXPECT_EQ(status.refusal, QUIESCE_TABLE_OK);
}

TEST_F(InTheLoop, the_configurations_is_used_where_nothing_is_stored) {
    start.stored[ROAD_LAW].writes = 9; // of what is not used any more
    start.configured[QUIESCE_OF_LAW] = rules(2);
    tables->use(start);
    EXPECT_EQ(in_use(), rules(2)[1]);
    const RoadStatus status = tables->status()[ROAD_LAW];
    EXPECT_EQ(status.source, TABLE_FROM_CONFIG);
    EXPECT_EQ(status.stored_crc, 0U);
    EXPECT_EQ(status.writes, 9U);
}

TEST_F(InTheLoop, a_stored_table_that_is_refused_makes_way) {
    start.stored[ROAD_LAW] = {shipped(QUIESCE_LAW_PHASE), 1};
    start.configured[QUIESCE_OF_LAW] = rules(2);
    tables->use(start);
    EXPECT_EQ(in_use(), rules(2)[1]);
    const std::string lines = log();
    EXPECT_NE(lines.find("the law's table (stored) is refused: not a table that this law"),
              std::string::npos)
        << lines;
    EXPECT_NE(lines.find("the law's table: rules, CRC "), std::string::npos) << lines;
    EXPECT_NE(lines.find("(configuration)"), std::string::npos) << lines;
}

TEST_F(InTheLoop, a_stored_table_of_another_law_waits_for_it_and_says_so) {
    const TableWords pulses = shipped(QUIESCE_LAW_PHASE);
    start.stored[ROAD_LAW] = {pulses, 1};
    tables->use(start);
    EXPECT_NE(log().find("the law's table (stored) waits: it is used once the parameters that it "
                         "was made for are applied"),
              std::string::npos);
    tables->tell();
    EXPECT_EQ(log(), ""); // once
    const quiesce_params_t params = params_of(QUIESCE_LAW_PHASE);
    node_restart(node.get(), &params);
    EXPECT_EQ(in_use(), pulses[1]);
    EXPECT_EQ(tables->status()[ROAD_LAW].source, TABLE_FROM_STORE);
    EXPECT_EQ(tables->status()[ROAD_LAW].refusal, QUIESCE_TABLE_OK);
    tables->tell();
    EXPECT_NE(log().find("the law's table: pulses, CRC "), std::string::npos);
}

TEST_F(InTheLoop, a_stored_table_that_the_configurations_replaces_is_told_how_to_use) {
    start.stored[ROAD_LAW] = {shipped(QUIESCE_LAW_PHASE), 1};
    start.configured[QUIESCE_OF_LAW] = rules(2);
    tables->use(start);
    const std::string lines = log();
    EXPECT_NE(lines.find("the law's table (stored) can be used again: apply and save"),
              std::string::npos)
        << lines;
    EXPECT_EQ(lines.find("waits"), std::string::npos) << lines;
}

TEST_F(InTheLoop, what_ships_is_used_where_all_are_refused) {
    start.stored[ROAD_LAW] = {shipped(QUIESCE_LAW_PHASE), 1};
    start.configured[QUIESCE_OF_LAW] = shipped(QUIESCE_LAW_PHASE);
    tables->use(start);
    EXPECT_EQ(in_use(), shipped(QUIESCE_LAW_FUZZY)[1]);
    EXPECT_EQ(tables->status()[ROAD_LAW].source, TABLE_SHIPS);
    EXPECT_EQ(tables->status()[ROAD_LAW].refusal, QUIESCE_TABLE_MAGIC);
}

class WithoutATable : public InTheLoop {
  protected:
    WithoutATable() : InTheLoop(QUIESCE_LAW_LINEAR) {}
};

TEST_F(WithoutATable, a_law_that_ships_none_says_so) {
    start.stored[ROAD_LAW] = {rules(1), 1};
    tables->use(start);
    EXPECT_EQ(in_use(), 0U);
    EXPECT_NE(log().find("linear has no table: it requests nothing until one is loaded"),
              std::string::npos);
    EXPECT_EQ(tables->status()[ROAD_LAW].source, TABLE_FROM_NOWHERE);
    tables->tell();
    EXPECT_EQ(log(), ""); // once
}

TEST_F(InTheLoop, another_table_of_the_configuration_is_used_after_some_ticks) {
    tables->use(start);
    offer(rules(1));
    EXPECT_GT(ticks_until_taken(), 1); // summed in parts
    EXPECT_EQ(in_use(), rules(1)[1]);
    EXPECT_NE(log().find("(configuration)"), std::string::npos);
    offer(rules(2));
    EXPECT_LT(ticks_until_taken(), kTicks);
    EXPECT_EQ(in_use(), rules(2)[1]);
    EXPECT_TRUE(quiesce_tables_revert(&node->tables.tables, &node->controller, QUIESCE_OF_LAW));
    EXPECT_EQ(in_use(), rules(1)[1]);
    offer({}); // none any more
    EXPECT_EQ(ticks_until_taken(), 1);
    EXPECT_EQ(in_use(), shipped(QUIESCE_LAW_FUZZY)[1]);
}

TEST_F(InTheLoop, one_that_is_refused_changes_nothing) {
    start.stored[ROAD_LAW] = {rules(1), 1};
    tables->use(start);
    (void)log();
    for (TableWords words : {shipped(QUIESCE_LAW_PHASE), rules(2)}) {
        words.back() ^= words[1] == rules(2)[1] ? 1U : 0U; // damaged on its way
        offer(words);
        EXPECT_LT(ticks_until_taken(), kTicks);
        EXPECT_EQ(in_use(), rules(1)[1]);
        EXPECT_EQ(log().rfind("the law's table stays: the configuration's is refused: ", 0), 0U);
    }
}

TEST_F(InTheLoop, a_transfer_over_the_bus_meanwhile_does_not_get_into_it) {
    tables->use(start);
    const TableWords sent = rules(2);
    offer(rules(1));
    for (std::uint32_t i = 0; exchange->new_tables[QUIESCE_OF_LAW].is_full(); ++i) {
        ASSERT_LT(i, sent.size());
        tables->take();
        if (i < 40) {
            (void)quiesce_tables_write(&node->tables.tables, i % 20, &sent[i], 1);
        }
    }
    EXPECT_EQ(in_use(), rules(1)[1]);
}

TEST_F(InTheLoop, the_law_of_the_same_reading_comes_first) {
    tables->use(start);
    ASSERT_TRUE(exchange->new_params.put(params_of(QUIESCE_LAW_PHASE)));
    offer(rules(1));
    EXPECT_EQ(ticks_until_taken(), kTicks);
    quiesce_params_t params{};
    ASSERT_TRUE(exchange->new_params.take(params));
    EXPECT_LT(ticks_until_taken(), kTicks);
    EXPECT_EQ(in_use(), rules(1)[1]);
}

class Learning : public InTheLoop {
  protected:
    Learning() : InTheLoop(QUIESCE_LAW_PHASE) {}
};

TEST_F(Learning, what_was_learnt_goes_out_at_the_end_and_comes_back) {
    tables->use(start);
    tables->store_last();
    StoreOrder order{};
    ASSERT_TRUE(exchange->to_store.take(order));
    EXPECT_EQ(order.record, KEEPER_LEARNT);
    exchange->store_result.store(StoreResult::stored);
    tables->take();
    EXPECT_EQ(tables->status()[ROAD_LEARNT].writes, 1U);
    EXPECT_EQ(tables->status()[ROAD_LEARNT].stored_crc, order.of.words[1]);
    tables->store_last(); // it is there
    EXPECT_FALSE(exchange->to_store.is_full());

    const auto begin = order.of.words.begin();
    start.stored[ROAD_LEARNT] = {TableWords(begin, begin + order.of.count), 1};
    init(QUIESCE_LAW_PHASE);
    tables->use(start);
    EXPECT_EQ(log(), "what was learnt before is used\n");
    tables->store_last(); // nothing new
    EXPECT_FALSE(exchange->to_store.is_full());
    init(QUIESCE_LAW_FUZZY);
    tables->use(start);
    EXPECT_EQ(log(), "what was learnt (stored) is refused: it belongs to another law, table or "
                     "setting\n");
}

TEST_F(Learning, a_store_that_is_full_is_asked_again) {
    tables->use(start);
    ASSERT_TRUE(exchange->to_store.put(StoreOrder{}));
    keeper_t &keeper = node->tables.keeper;
    const TableWords words = rules(1);
    const auto count = static_cast<std::uint32_t>(words.size());
    EXPECT_FALSE(keeper_begin(&keeper, KEEPER_LAW_TABLE, words[1], words.data(), count));
    StoreOrder order{};
    ASSERT_TRUE(exchange->to_store.take(order));
    EXPECT_TRUE(keeper_begin(&keeper, KEEPER_LAW_TABLE, words[1], words.data(), count));
    ASSERT_TRUE(exchange->to_store.take(order));
    EXPECT_EQ(order.of.count, count);
    EXPECT_EQ(order.of.words[1], words[1]);
    exchange->store_result.store(StoreResult::failed);
    tables->take();
    EXPECT_EQ(keeper.under_way, KEEPER_RECORDS);
    EXPECT_EQ(keeper.kept[KEEPER_LAW_TABLE].writes, 0U);
}

TEST_F(InTheLoop, the_status_file_tells_of_each_road) {
    start.stored[ROAD_LAW] = {shipped(QUIESCE_LAW_PHASE), 1};
    start.stored[ROAD_TRACKER].state = KEEPER_LOST;
    tables->use(start);
    Snapshot snapshot{};
    snapshot.roads = tables->status();
    const std::string json = status_json(Config(), snapshot);
    const std::string law = "\"law\": {\"kind\": \"rules\", \"crc\": " + std::to_string(in_use()) +
                            ", \"source\": \"ships\", ";
    for (const std::string &part :
         {law,
          std::string("\"writes\": 1, \"record\": \"whole\", \"refusal\": \"not a table that this "
                      "law"),
          std::string(
              "\"tracker\": {\"kind\": null, \"crc\": 0, \"source\": \"none\", "
              "\"stored_crc\": 0, \"writes\": 0, \"record\": \"lost\", \"refusal\": null}")}) {
        EXPECT_NE(json.find(part), std::string::npos) << part << " in\n" << json;
    }
}

} // namespace
} // namespace quiesced
