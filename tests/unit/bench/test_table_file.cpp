/// --rules, --law-table, --force-map and table-check: tables from files, and what a user reads
/// where one is not good.
#include "table_file.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "bench_call.h"
#include "board_crc.h"
#include "board_file.h"
#include "input_error.h"
#include "table_files.h"

#include "plant_rules.h"

namespace {

using quiesce::bench;
using quiesce::InputError;
using quiesce::Outcome;
using quiesce::TempFile;
using quiesce::with_crc;
using quiesce::Words;

// Places in a table's header (firmware/fuzzy/fuzzy_table.h).
constexpr std::size_t kMagic = 0, kCrc = 1, kSize = 2, kShape = 3, kAxis = 4, kRules = 8,
                      kOutput = 9, kOrigin = 14;
constexpr std::uint32_t kRuleWords = 4, kOutputOrigin = 2;

Words shipped() {
    return Words(std::begin(plant_rules_table), std::end(plant_rules_table));
}

Words raised(std::uint32_t by_mA) {
    Words words = shipped();
    words[kOrigin] += by_mA;
    words[words[kOutput] + kOutputOrigin] += by_mA;
    return with_crc(words);
}

// A good table of one input: every rule asks twice for what it asked of the first.
Words of_one_input() {
    Words words = shipped();
    words[kShape] = (words[kShape] & 0x00FFFF00u) | 1u;
    const std::uint32_t offset = words[kRules] & 0xFFFFu;
    for (std::uint32_t i = 0; i < words[kRules] >> 16; ++i) {
        std::uint32_t &conditions = words[offset + kRuleWords * i + 1];
        conditions = (conditions & 0xFFu) * 0x0101u;
    }
    return with_crc(words);
}

std::string message_of(const quiesce::TableFiles &files) {
    try {
        (void)quiesce::load_tables(files);
    } catch (const InputError &error) {
        return error.what();
    }
    return "accepted";
}

TEST(TableFiles, are_loaded_in_the_order_in_which_they_are_used) {
    const Words law = {1, 2, 3, 4}; // looked at once it is known which law runs
    const TempFile rules(shipped()), other(law);
    const std::vector<Words> loaded = quiesce::load_tables({rules.name(), "", other.name(), ""});
    EXPECT_EQ(loaded, (std::vector<Words>{shipped(), law}));
    EXPECT_TRUE(quiesce::load_tables({}).empty());
}

struct Damage {
    const char *name;
    std::function<Words()> words;
    const char *message;
};

void PrintTo(const Damage &damage, std::ostream *out) {
    *out << damage.name;
}

Words changed(std::size_t place, std::uint32_t value) {
    Words words = shipped();
    words[place] = value;
    return place == kCrc || place == kSize ? words : with_crc(words);
}

Words without_last_word() {
    Words words = shipped();
    words.pop_back();
    return words;
}

const Damage kDamages[] = {
    {"four_words",
     [] {
         return Words{shipped()[kMagic], 0, 4, 0};
     },
     "it is shorter than it says"},
    {"cut", without_last_word, "it is shorter than it says, or too long"},
    {"size", [] { return changed(kSize, 70000); }, "it is shorter than it says, or too long"},
    {"magic", [] { return changed(kMagic, 0x12345678); },
     "it is not a table for this law or tracker"},
    {"crc", [] { return changed(kCrc, 0); }, "its checksum is wrong: it is damaged"},
    {"shape", [] { return changed(kShape, 0); }, "its numbers of inputs, outputs, rules or points"},
    {"cell", [] { return changed(kAxis, 0); }, "a membership is out of range"},
    {"rule", [] { return changed(kRules, 16u << 16); }, "a rule names what is not there"},
    {"output", [] { return changed(kOrigin, 1); }, "a term is out of range"},
    {"fit", of_one_input, "have two inputs, frequency in uHz"},
};

class DamagedRuleFile : public testing::TestWithParam<Damage> {};

TEST_P(DamagedRuleFile, is_refused_with_file_and_reason) {
    const TempFile file(GetParam().words());
    const std::string message = message_of({file.name(), "", "", ""});
    EXPECT_EQ(message.rfind(file.name(), 0), 0u) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
}

TEST_P(DamagedRuleFile, ends_a_run_with_2_and_one_line) {
    const TempFile file(GetParam().words());
    const Outcome outcome = bench("run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law fuzzy "
                                  "--rules " +
                                  file.name());
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.output.rfind("quiesce_bench: ", 0), 0u) << outcome.output;
    EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
    EXPECT_NE(outcome.output.find(GetParam().message), std::string::npos) << outcome.output;
}

INSTANTIATE_TEST_SUITE_P(RuleFile, DamagedRuleFile, testing::ValuesIn(kDamages),
                         [](const auto &test) { return std::string(test.param.name); });

nlohmann::json fuzzy_run(const std::string &options) {
    const Outcome outcome =
        bench("run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law fuzzy " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output);
}

TEST(RuleFile, the_table_is_what_the_controller_runs) {
    const nlohmann::json plain = fuzzy_run("");
    const TempFile same(shipped());
    EXPECT_EQ(fuzzy_run("--rules " + same.name())["telemetry_crc32"], plain["telemetry_crc32"]);
    const TempFile more(raised(1500));
    const nlohmann::json out = fuzzy_run("--rules " + more.name());
    EXPECT_NEAR(plain["mean_current_A"].get<double>(), 0.0, 0.01);
    EXPECT_NEAR(out["mean_current_A"].get<double>(), 1.5, 0.01);
}

// Of each axis two places, two currents, four forces; 3: stroke, 4: its velocity.
Words force_map(const std::vector<std::uint32_t> &axes = {4u}) {
    const auto count = static_cast<std::uint32_t>(axes.size());
    Words words = {0x32464D51u, 0, 4u + 11u * count, count};
    for (const std::uint32_t axis : axes) {
        words.insert(words.end(),
                     {axis, 2, 2, 0xFFFFFC18u, 1000, 0, 2000, 0xFFFFFFFFu, 0xFFFFFC18u, 1, 1000});
    }
    return with_crc(words);
}

std::string map_message(const Words &words) {
    const TempFile file(words);
    const std::string message = message_of({"", "", "", file.name()});
    return message == "accepted" ? message : message.substr(file.name().size());
}

TEST(ForceMapFile, is_read_or_refused_with_the_reason) {
    constexpr const char *kRefused = ": the controller refuses the table: ";
    constexpr std::size_t kForce = 11;
    Words words = force_map();
    EXPECT_EQ(map_message(words), "accepted");
    words[kForce] = 0xFFFFFC17u; // more than with current
    EXPECT_EQ(map_message(words).rfind(std::string(kRefused) + "its checksum", 0), 0u);
    words = with_crc(words);
    EXPECT_NE(map_message(words).find("force does not grow with the current"), std::string::npos);
    words.pop_back();
    EXPECT_EQ(map_message(words).rfind(std::string(kRefused) + "it is shorter", 0), 0u);
    EXPECT_EQ(map_message(shipped()).rfind(std::string(kRefused) + "it is not a table", 0), 0u);
}

// The first version of a map: without sections.
TEST(ForceMapFile, an_old_one_is_refused) {
    const Words words = with_crc(
        {0x31464D51u, 0, 13, 2, 2, 0xFFFFFC18u, 1000, 0, 2000, 0xFFFFFFFFu, 0xFFFFFC18u, 1, 1000});
    EXPECT_NE(map_message(words).find(
                  "it is not a table for this law or tracker, or one of another version"),
              std::string::npos);
}

TEST(ForceMapFile, is_left_by_a_law_that_demands_no_forces) {
    const TempFile file(force_map());
    EXPECT_EQ(bench("run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --force-map " +
                    file.name())
                  .exit_code,
              0);
}

// Friction of the first damper: 5 kN/m of the last peak, at most 30 N.
Words friction() {
    return with_crc({0x31524651u, 0, 9, 1, 5000, 100000, 30000, 200, 3});
}

constexpr const char *kTwoStoreys =
    "run --scenario sim_hil/data/rigs/two_storeys.toml --law friction --set tracker=";

std::string refusal(const std::string &options) {
    const Outcome outcome = bench(kTwoStoreys + options);
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.output;
}

TEST(LawTable, runs_with_its_map_and_is_missed_without) {
    const TempFile table(friction());
    const TempFile map(force_map());
    const std::string both = "inverse --law-table " + table.name() + " --force-map " + map.name();
    const Outcome outcome = bench(kTwoStoreys + both);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_EQ(refusal("inverse"),
              "quiesce_bench: law friction works with a table: --law-table FILE "
              "(quiesce law make)\n");
    EXPECT_EQ(refusal("inverse --law-table " + table.name()),
              "quiesce_bench: tracker inverse works with a damper's map: --force-map FILE (quiesce "
              "identify inverse)\n");
}

// The board has two dampers; it knows a stroke of each.
TEST(LawTable, a_map_is_of_the_boards_dampers) {
    const TempFile table(friction());
    for (const std::vector<std::uint32_t> &axes :
         std::vector<std::vector<std::uint32_t>>{{3}, {4, 3}, {3, 4}}) {
        const TempFile map(force_map(axes));
        const Outcome outcome = bench(kTwoStoreys + ("inverse --law-table " + table.name()) +
                                      " --force-map " + map.name());
        EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    }
    const TempFile three(force_map({4, 4, 4}));
    EXPECT_EQ(
        refusal("inverse --law-table " + table.name() + " --force-map " + three.name()),
        "quiesce_bench: " + three.name() +
            ": the controller refuses the table: it is of more dampers than this board has, or "
            "over a stroke that no sensor tells (quiesce board show), or a bank for another "
            "tick_rate_Hz\n");
}

// Half of the demand and of the velocity of the stroke, by a straight line; least speed 1 mm/s.
Words network_of_dampers(std::uint32_t count) {
    Words words = {0x314E5451u, 0, 4u + 26u * count, count};
    for (std::uint32_t i = 0; i < count; ++i) {
        words.insert(words.end(), {1000, 1500, 2, 0, 0, 1});
        for (const std::uint32_t signal : {64u, 4u}) {
            words.insert(words.end(), {signal, 0xFFF00000u, 0x100000u, 16, 0});
        }
        words.insert(words.end(), {1, 1, 1, 0, 1, 1, 0, 0, 0, 1000});
    }
    return with_crc(words);
}

TEST(LawTable, a_network_is_of_its_tracker_and_of_the_boards_dampers) {
    const TempFile table(friction());
    const std::string with = " --law-table " + table.name() + " --force-map ";
    const TempFile two(network_of_dampers(2));
    const Outcome outcome = bench(kTwoStoreys + ("network" + with) + two.name());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_NE(refusal("inverse" + with + two.name()).find("it is not a table for this law"),
              std::string::npos);
    const TempFile three(network_of_dampers(3));
    EXPECT_NE(refusal("network" + with + three.name()).find("a signal or a damper that"),
              std::string::npos);
    Words words = network_of_dampers(1);
    words[5] = 20001; // mA
    const TempFile current(with_crc(words));
    EXPECT_NE(refusal("network" + with + current.name()).find("current is out of range"),
              std::string::npos);
}

TEST(LawTable, is_refused_with_the_reason) {
    Words words = friction();
    words[8] = 0;
    const TempFile ways(with_crc(words));
    EXPECT_EQ(
        refusal("inverse --law-table " + ways.name()),
        "quiesce_bench: " + ways.name() +
            ": the controller refuses the table: a coefficient, limit, band, power or current "
            "is out of range\n");
    Words three = {0x31524651u, 0, 19, 3};
    for (std::uint32_t i = 0; i < 3; ++i) {
        three.insert(three.end(), {5000, 100000, 30000, 200, 3});
    }
    const TempFile dampers(with_crc(three)); // the board has two
    EXPECT_NE(refusal("inverse --law-table " + dampers.name()).find("a signal or a damper that"),
              std::string::npos);
    const TempFile rules(shipped());
    EXPECT_NE(refusal("inverse --law-table " + rules.name()).find("it is not a table for this law"),
              std::string::npos);
}

constexpr const char *kBoard = "sim_hil/data/boards/two_storeys.toml";

std::uint32_t board_of_rig() {
    return quiesce::board_crc32(quiesce::load_board(kBoard).board);
}

TEST(BoardOfTable, another_boards_table_is_refused) {
    const TempFile map(force_map());
    for (const std::uint32_t board : {0u, board_of_rig()}) {
        const TempFile table(friction(), board);
        const Outcome outcome = bench(kTwoStoreys + ("inverse --law-table " + table.name()) +
                                      " --force-map " + map.name());
        EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    }
    const TempFile table(friction(), 0xABCDEFu);
    char own[16];
    std::snprintf(own, sizeof own, "0x%08x", static_cast<unsigned>(board_of_rig()));
    EXPECT_EQ(refusal("inverse --force-map " + map.name() + " --law-table " + table.name()),
              "quiesce_bench: " + table.name() + ": made for board 0x00abcdef, and this is board " +
                  own + "; make it anew, or say that it fits with `quiesce table stamp`\n");
}

TEST(BoardOfTable, is_asked_of_every_option_and_of_no_run_without_a_board) {
    const TempFile rules(shipped(), 1), map(force_map(), 1);
    for (const std::string &given : {"--rules " + rules.name(), "--force-map " + map.name()}) {
        const Outcome outcome =
            bench("run --scenario sim_hil/data/rigs/two_storeys.toml --law off " + given);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_NE(outcome.output.find("made for board 0x00000001"), std::string::npos);
    }
    EXPECT_EQ(fuzzy_run("--rules " + rules.name())["law"], "fuzzy");
}

nlohmann::json checked(const Words &words, const std::string &options = "",
                       std::uint32_t board = 0) {
    const TempFile file(words, board);
    const Outcome outcome = bench("table-check --file " + file.name() + " " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output);
}

const std::string kOnBoard = "--board " + std::string(kBoard);

TEST(TableCheck, tells_who_takes_a_table_and_whether) {
    const nlohmann::json rules = checked(shipped());
    EXPECT_EQ(rules["verdict"], QUIESCE_TABLE_OK);
    EXPECT_EQ(rules["reason"], "accepted");
    EXPECT_EQ(rules["words"], shipped().size());
    EXPECT_EQ(rules["laws"], (std::vector<std::string>{"fuzzy", "fuzzy_selftune"}));
    EXPECT_TRUE(rules["trackers"].empty());
    const nlohmann::json map = checked(force_map());
    EXPECT_EQ(map["verdict"], QUIESCE_TABLE_OK);
    EXPECT_TRUE(map["laws"].empty());
    EXPECT_EQ(map["trackers"], std::vector<std::string>{"inverse"});
    EXPECT_EQ(checked(friction())["laws"], std::vector<std::string>{"friction"});
    EXPECT_EQ(checked(network_of_dampers(1))["trackers"], std::vector<std::string>{"network"});
}

TEST(TableCheck, has_the_controllers_verdict) {
    EXPECT_EQ(checked({1, 2, 3, 4})["verdict"], QUIESCE_TABLE_MAGIC);
    EXPECT_TRUE(checked({1, 2, 3, 4})["laws"].empty());
    EXPECT_EQ(checked(changed(kCrc, 0))["verdict"], QUIESCE_TABLE_CRC);
    EXPECT_EQ(checked(of_one_input())["verdict"], QUIESCE_TABLE_FIT);
    Words words = friction();
    words[8] = 0;
    EXPECT_EQ(checked(with_crc(words))["verdict"], QUIESCE_TABLE_POINT);
    words.pop_back();
    EXPECT_EQ(checked(words)["verdict"], QUIESCE_TABLE_SIZE);
    words = force_map();
    words[6] = 40; // currents
    EXPECT_EQ(checked(with_crc(words))["verdict"], QUIESCE_TABLE_SHAPE);
}

TEST(TableCheck, asks_a_board_where_one_is_named) {
    EXPECT_EQ(checked(force_map({4, 4, 4}))["verdict"], QUIESCE_TABLE_OK);
    EXPECT_EQ(checked(force_map({4, 4, 4}), kOnBoard)["verdict"], QUIESCE_TABLE_FIT);
    EXPECT_EQ(checked(force_map({4, 4}), kOnBoard)["verdict"], QUIESCE_TABLE_OK);
    EXPECT_EQ(checked(friction(), kOnBoard, 5)["is_for_board"], false);
    EXPECT_EQ(checked(friction(), "", 5)["is_for_board"], true);
    EXPECT_EQ(checked(friction(), kOnBoard, board_of_rig())["is_for_board"], true);
    EXPECT_EQ(checked(friction(), kOnBoard, board_of_rig())["board"], board_of_rig());
}

TEST(TableCheck, of_what_was_learnt_knows_head_and_checksum) {
    const Words words = with_crc({0x31544C51u, 0, 6, 7, 8, 9});
    EXPECT_EQ(checked(words)["verdict"], QUIESCE_TABLE_OK);
    EXPECT_EQ(checked(words, kOnBoard)["verdict"], QUIESCE_TABLE_OK);
    Words damaged = words;
    damaged[5]++;
    EXPECT_EQ(checked(damaged)["verdict"], QUIESCE_TABLE_CRC);
    damaged.pop_back();
    EXPECT_EQ(checked(damaged)["verdict"], QUIESCE_TABLE_SIZE);
}

TEST(TableCheck, ends_with_2_where_there_is_no_table_file) {
    for (const char *words : {"", "--file", "--file no/such/file", "--file sim_hil --board none",
                              "--file sim_hil/data/boards/two_storeys.toml", "FILE"}) {
        const Outcome outcome = bench("table-check " + std::string(words));
        EXPECT_EQ(outcome.exit_code, 2) << words;
        EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
    }
}

TEST(BoardCrc, is_of_its_words_and_told_by_board_check) {
    const Outcome outcome = bench("board-check " + std::string(kBoard));
    const nlohmann::json out = nlohmann::json::parse(outcome.output);
    Words words;
    for (const nlohmann::json &word : out["words"]) {
        words.push_back(static_cast<std::uint32_t>(word.get<std::int32_t>()));
    }
    EXPECT_EQ(out["crc32"], board_of_rig());
    EXPECT_EQ(out["crc32"], quiesce::crc32_of(words.data(), words.size()));
}

} // namespace
