/// --rules, --force-map: tables from text files, and what a user reads where one is not good.
#include "table_file.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "bench_call.h"
#include "crc32.h"
#include "input_error.h"

extern "C" {
#include "plant_rules.h"
}

namespace {

using quiesce::bench;
using quiesce::InputError;
using quiesce::Outcome;
using Words = std::vector<std::uint32_t>;

// Places in a table's header (firmware/fuzzy/fuzzy_table.h).
constexpr std::size_t kMagic = 0, kCrc = 1, kSize = 2, kShape = 3, kAxis = 4, kRules = 8,
                      kOutput = 9, kOrigin = 14;
constexpr std::uint32_t kRuleWords = 4, kOutputOrigin = 2;

Words shipped() {
    return Words(std::begin(plant_rules_table), std::end(plant_rules_table));
}

Words with_crc(Words words) {
    quiesce::Crc32 crc;
    crc.append(words.data() + kSize, words.size() - kSize);
    words[kCrc] = crc.value();
    return words;
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

std::string hex(const Words &words) {
    std::string text;
    char line[16];
    for (const std::uint32_t word : words) {
        std::snprintf(line, sizeof line, "%08X\n", static_cast<unsigned>(word));
        text += line;
    }
    return text;
}

/// A text file that goes with the object.
class TextFile {
  public:
    explicit TextFile(const std::string &text)
        : name_((std::filesystem::temp_directory_path() /
                 ("quiesce_rules_" + std::to_string(::getpid()) + "_" + std::to_string(made_++)))
                    .string()) {
        std::ofstream(name_, std::ios::binary) << text;
    }
    ~TextFile() { std::filesystem::remove(name_); }
    TextFile(const TextFile &) = delete;
    TextFile &operator=(const TextFile &) = delete;

    const std::string &name() const { return name_; }

  private:
    inline static int made_ = 0;
    std::string name_;
};

std::string message_of(const std::string &file) {
    try {
        quiesce::load_rules(file);
    } catch (const InputError &error) {
        return error.what();
    }
    return "accepted";
}

TEST(RuleFile, good_words_are_read_in_any_writing) {
    const Words words = shipped();
    EXPECT_EQ(quiesce::load_rules(TextFile(hex(words)).name()), words);
    std::string text = " \r\n\t";
    char word[16];
    for (std::size_t i = 0; i < words.size(); ++i) {
        std::snprintf(word, sizeof word, i % 2 == 0 ? "%x" : "0x%X",
                      static_cast<unsigned>(words[i]));
        text += word + std::string(i % 3 == 0 ? "\r\n" : "  ");
    }
    EXPECT_EQ(quiesce::load_rules(TextFile(text).name()), words);
}

struct Damage {
    const char *name;
    std::function<std::string()> text;
    const char *message;
};

void PrintTo(const Damage &damage, std::ostream *out) {
    *out << damage.name;
}

std::string changed(std::size_t place, std::uint32_t value) {
    Words words = shipped();
    words[place] = value;
    return hex(place == kCrc || place == kSize ? words : with_crc(words));
}

std::string without_last_word() {
    Words words = shipped();
    words.pop_back();
    return hex(words);
}

const Damage kDamages[] = {
    {"empty", [] { return std::string(); }, "holds no words of a rule table"},
    {"blank", [] { return std::string("\n \t\n"); }, "holds no words of a rule table"},
    {"not_hex", [] { return std::string("FUNCTION_BLOCK x"); },
     "word 1: 'FUNCTION_BLOCK' is no 32-bit hexadecimal number"},
    {"trailing_letter",
     [] {
         return hex({1, 2}) + "0000002Ag\n";
     },
     "word 3: '0000002Ag'"},
    {"trailing_text", [] { return hex(shipped()) + "end\n"; }, "'end' is no 32-bit hex"},
    {"too_many_digits", [] { return std::string("1FFFFFFFF"); }, "word 1: '1FFFFFFFF'"},
    {"far_too_many_digits", [] { return std::string(5000, 'F'); }, "'FFFFFFFFFFFFFFFFFFFF' is"},
    {"negative", [] { return std::string("-1"); }, "word 1: '-1'"},
    {"decimal_point", [] { return std::string("1.5"); }, "word 1: '1.5'"},
    {"zero_byte", [] { return hex({1}) + std::string(3, '\0'); }, "word 2: "},
    {"one_word", [] { return hex({shipped()[kMagic]}); }, "it is shorter than it says"},
    {"cut", without_last_word, "it is shorter than it says, or too long"},
    {"size", [] { return changed(kSize, 70000); }, "it is shorter than it says, or too long"},
    {"magic", [] { return changed(kMagic, 0x12345678); }, "it is not a table for this law"},
    {"crc", [] { return changed(kCrc, 0); }, "its checksum is wrong: it is damaged"},
    {"shape", [] { return changed(kShape, 0); }, "its numbers of inputs, outputs, rules or points"},
    {"cell", [] { return changed(kAxis, 0); }, "a membership is out of range"},
    {"rule", [] { return changed(kRules, 16u << 16); }, "a rule names what is not there"},
    {"output", [] { return changed(kOrigin, 1); }, "a term is out of range"},
    {"fit", [] { return hex(of_one_input()); }, "have two inputs, frequency in uHz"},
};

class DamagedRuleFile : public testing::TestWithParam<Damage> {};

TEST_P(DamagedRuleFile, is_refused_with_file_and_reason) {
    const TextFile file(GetParam().text());
    const std::string message = message_of(file.name());
    EXPECT_EQ(message.rfind(file.name(), 0), 0u) << message;
    EXPECT_NE(message.find(GetParam().message), std::string::npos) << message;
}

TEST_P(DamagedRuleFile, ends_a_run_with_2_and_one_line) {
    const TextFile file(GetParam().text());
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

TEST(RuleFile, missing_file_and_folder_are_told) {
    EXPECT_EQ(message_of("no/such/file"), "no/such/file: cannot be read");
    EXPECT_NE(message_of(std::filesystem::temp_directory_path().string()), "accepted");
}

TEST(RuleFile, only_the_host_takes_a_table) {
    const TextFile file(hex(shipped()));
    for (const char *target : {"mps2", "mps2-uart"}) {
        const Outcome outcome =
            bench("run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law fuzzy "
                  "--image none.elf --target " +
                  std::string(target) + " --rules " + file.name());
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(outcome.output,
                  "quiesce_bench: --rules: only the host target takes a rule table\n");
    }
}

nlohmann::json fuzzy_run(const std::string &options) {
    const Outcome outcome =
        bench("run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law fuzzy " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return nlohmann::json::parse(outcome.output);
}

TEST(RuleFile, the_table_is_what_the_controller_runs) {
    const nlohmann::json plain = fuzzy_run("");
    const TextFile same(hex(shipped()));
    EXPECT_EQ(fuzzy_run("--rules " + same.name())["telemetry_crc32"], plain["telemetry_crc32"]);
    const TextFile more(hex(raised(1500)));
    const nlohmann::json out = fuzzy_run("--rules " + more.name());
    EXPECT_NEAR(plain["mean_current_A"].get<double>(), 0.0, 0.01);
    EXPECT_NEAR(out["mean_current_A"].get<double>(), 1.5, 0.01);
}

TEST(UseTable, refuses_with_the_reason_alone) {
    quiesce_params_t params;
    quiesce_params_default(&params);
    const auto controller = std::make_unique<quiesce_t>();
    ASSERT_TRUE(quiesce_init(controller.get(), &params));
    Words words = shipped();
    EXPECT_NO_THROW(quiesce::use_table(*controller, words));
    words[kCrc]++;
    try {
        quiesce::use_table(*controller, words);
        FAIL() << "accepted";
    } catch (const InputError &error) {
        EXPECT_STREQ(error.what(), "the controller refuses the table: its checksum is wrong: it is "
                                   "damaged");
    }
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
    const TextFile file(hex(words));
    try {
        EXPECT_EQ(quiesce::load_force_map(file.name()), words);
    } catch (const InputError &error) {
        return std::string(error.what()).substr(file.name().size());
    }
    return "accepted";
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
    const TextFile nothing("");
    EXPECT_THROW(quiesce::load_force_map(nothing.name()), InputError);
}

// The first version of a map: without sections.
TEST(ForceMapFile, an_old_one_is_refused) {
    const Words words = with_crc(
        {0x31464D51u, 0, 13, 2, 2, 0xFFFFFC18u, 1000, 0, 2000, 0xFFFFFFFFu, 0xFFFFFC18u, 1, 1000});
    EXPECT_NE(map_message(words).find("it is not a table for this law, or one of another version"),
              std::string::npos);
}

TEST(ForceMapFile, only_the_host_takes_one) {
    const TextFile file(hex(force_map()));
    const std::string run = "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off ";
    const std::string option = "--force-map " + file.name();
    EXPECT_EQ(bench(run + option).exit_code, 0);
    const Outcome outcome = bench(run + "--target mps2 --image none.elf " + option);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.output,
              "quiesce_bench: --force-map: only the host target takes a damper's map\n");
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
    const TextFile table(hex(friction()));
    const TextFile map(hex(force_map()));
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
    const TextFile table(hex(friction()));
    for (const std::vector<std::uint32_t> &axes :
         std::vector<std::vector<std::uint32_t>>{{3}, {4, 3}, {3, 4}}) {
        const TextFile map(hex(force_map(axes)));
        const Outcome outcome = bench(kTwoStoreys + ("inverse --law-table " + table.name()) +
                                      " --force-map " + map.name());
        EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    }
    const TextFile three(hex(force_map({4, 4, 4})));
    EXPECT_EQ(refusal("inverse --law-table " + table.name() + " --force-map " + three.name()),
              "quiesce_bench: " + three.name() +
                  ": the controller refuses the map: it is of more dampers than this board has, or "
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
    const TextFile table(hex(friction()));
    const std::string with = " --law-table " + table.name() + " --force-map ";
    const TextFile two(hex(network_of_dampers(2)));
    const Outcome outcome = bench(kTwoStoreys + ("network" + with) + two.name());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_NE(refusal("inverse" + with + two.name()).find("it is not a table for this law"),
              std::string::npos);
    const TextFile three(hex(network_of_dampers(3)));
    EXPECT_NE(refusal("network" + with + three.name()).find("a signal or a damper that"),
              std::string::npos);
    Words words = network_of_dampers(1);
    words[5] = 20001; // mA
    const TextFile current(hex(with_crc(words)));
    EXPECT_NE(refusal("network" + with + current.name()).find("current is out of range"),
              std::string::npos);
}

TEST(LawTable, is_refused_with_the_reason) {
    Words words = friction();
    words[8] = 0;
    const TextFile ways(hex(with_crc(words)));
    EXPECT_EQ(
        refusal("inverse --law-table " + ways.name()),
        "quiesce_bench: " + ways.name() +
            ": the controller refuses the table: a coefficient, limit, band, power or current "
            "is out of range\n");
    Words three = {0x31524651u, 0, 19, 3};
    for (std::uint32_t i = 0; i < 3; ++i) {
        three.insert(three.end(), {5000, 100000, 30000, 200, 3});
    }
    const TextFile dampers(hex(with_crc(three))); // the board has two
    EXPECT_NE(refusal("inverse --law-table " + dampers.name()).find("a signal or a damper that"),
              std::string::npos);
    const TextFile rules(hex(shipped()));
    EXPECT_NE(refusal("inverse --law-table " + rules.name()).find("it is not a table for this law"),
              std::string::npos);
}

TEST(LawTable, only_the_host_takes_one) {
    const TextFile table(hex(friction()));
    const TextFile map(hex(force_map()));
    EXPECT_EQ(refusal("inverse --target mps2 --image none.elf --law-table " + table.name()),
              "quiesce_bench: tracker inverse works with a damper's map: --force-map FILE (quiesce "
              "identify inverse)\n");
    const Outcome outcome = bench("run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off "
                                  "--target mps2 --image none.elf --law-table none");
    EXPECT_EQ(outcome.exit_code, 2);
}

} // namespace
