/// The executable as a user meets it: exit codes, one line on stderr, JSON on stdout.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "bench_call.h"
#include "firmware.h"

using quiesce::bench;
using quiesce::Outcome;

namespace {

const std::string kSine = "--scenario sim_hil/data/scenarios/sine_20Hz.toml ";

struct BadCall {
    const char *name;
    const char *words;
    const char *message;
};

void PrintTo(const BadCall &call, std::ostream *out) {
    *out << call.name;
}

class BadCalls : public testing::TestWithParam<BadCall> {};

TEST_P(BadCalls, exit_with_2_and_one_line) {
    const Outcome outcome = bench(GetParam().words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_EQ(outcome.output.rfind("quiesce_bench: ", 0), 0u) << outcome.output;
    EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
    EXPECT_NE(outcome.output.find(GetParam().message), std::string::npos) << outcome.output;
}

const BadCall kBadCalls[] = {
    {"no_command", "", "no command given"},
    {"unknown_command", "fly", "unknown command fly"},
    {"no_scenario", "run --law off", "--scenario is missing"},
    {"no_law", "run --scenario sim_hil/data/scenarios/sine_5Hz.toml", "--law is missing"},
    {"unknown_law", "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law magic",
     "--law magic"},
    {"missing_scenario", "run --scenario no.toml --law off", "no.toml"},
    {"missing_plant",
     "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --plant no.toml", "no.toml"},
    {"unknown_parameter",
     "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --set warp=9", "warp"},
    {"refused_parameter",
     "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --set tick_rate_Hz=999",
     "tick_rate_Hz"},
    {"unknown_target",
     "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --target moon",
     "unknown target"},
    {"bad_seed", "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --seed x",
     "--seed x"},
    {"plant_is_a_scenario", "plant-check sim_hil/data/scenarios/sine_5Hz.toml", "schema: expected"},
    {"no_file", "scenario-check", "expected exactly one FILE"},
    {"replay_without_counts", "replay --trace t", "--counts is missing"},
    {"replay_missing_counts", "replay --counts no.bin --trace t", "no.bin"},
    {"unwritable_trace",
     "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --trace no/such/file",
     "--trace"},
};
INSTANTIATE_TEST_SUITE_P(CommandLine, BadCalls, testing::ValuesIn(kBadCalls),
                         [](const auto &test) { return std::string(test.param.name); });

TEST(CommandLine, run_prints_one_json_object) {
    const Outcome outcome = bench("run " + kSine + "--law constant --set constant_current_mA=5000");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const nlohmann::json out = nlohmann::json::parse(outcome.output);
    for (const char *key : {"scenario",
                            "law",
                            "target",
                            "freq_hz",
                            "freq2_hz",
                            "amp_um",
                            "accel_rms_mm_s2",
                            "amp2_um",
                            "accel_rms2_mm_s2",
                            "mean_current_A",
                            "rms_disp_um",
                            "settle_s",
                            "instr_median",
                            "instr_worst",
                            "faults",
                            "seed",
                            "noise_mg",
                            "drive_V",
                            "ticks",
                            "wall_s",
                            "realtime_factor",
                            "distinct_commands",
                            "telemetry_crc32"}) {
        EXPECT_TRUE(out.contains(key)) << key;
    }
    EXPECT_EQ(out["law"], "constant");
    EXPECT_EQ(out["freq_hz"], 20.0);
    EXPECT_TRUE(out["settle_s"].is_null());
    EXPECT_TRUE(out["instr_median"].is_null());
    EXPECT_EQ(out["ticks"], 8000);
    EXPECT_NEAR(out["amp_um"].get<double>(), 10.71, 0.05);
    EXPECT_NEAR(out["mean_current_A"].get<double>(), 5.0, 1e-6);
}

TEST(CommandLine, step_has_two_phases_and_a_settling_time) {
    const Outcome outcome =
        bench("run --scenario sim_hil/data/scenarios/step_10_20Hz.toml --law off");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const nlohmann::json out = nlohmann::json::parse(outcome.output);
    EXPECT_EQ(out["freq_hz"], 10.0);
    EXPECT_EQ(out["freq2_hz"], 20.0);
    EXPECT_NEAR(out["settle_s"].get<double>(), 0.59, 0.01);
}

TEST(CommandLine, files_and_parameters_are_listed) {
    EXPECT_EQ(bench("plant-check sim_hil/data/plants/frame_3dof.toml").exit_code, 0);
    EXPECT_EQ(bench("scenario-check sim_hil/data/scenarios/trace_equality.toml").exit_code, 0);
    EXPECT_EQ(bench("--help").exit_code, 0);
    const Outcome outcome = bench("params");
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(outcome.output).size(), QUIESCE_PARAM_COUNT);
}

TEST(CommandLine, replay_refuses_half_a_count) {
    const std::string file =
        (std::filesystem::temp_directory_path() / ("quiesce_odd_" + std::to_string(::getpid())))
            .string();
    std::ofstream(file, std::ios::binary) << "12345";
    const Outcome outcome = bench("replay --counts " + file + " --trace " + file + ".trace");
    std::filesystem::remove(file);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.output.find("32-bit little-endian"), std::string::npos) << outcome.output;
    EXPECT_FALSE(std::filesystem::exists(file + ".trace"));
}

/// A file of counts that goes with the object.
class CountsFile {
  public:
    explicit CountsFile(const std::vector<std::int32_t> &counts)
        : name_((std::filesystem::temp_directory_path() /
                 ("quiesce_counts_" + std::to_string(::getpid())))
                    .string()) {
        std::ofstream(name_, std::ios::binary)
            .write(reinterpret_cast<const char *>(counts.data()),
                   static_cast<std::streamsize>(counts.size() * sizeof counts[0]));
    }
    ~CountsFile() {
        std::filesystem::remove(name_);
        std::filesystem::remove(trace_name());
    }
    CountsFile(const CountsFile &) = delete;
    CountsFile &operator=(const CountsFile &) = delete;

    std::string trace_name() const { return name_ + ".trace"; }

    Outcome replay(const std::string &options) const {
        return bench("replay --counts " + name_ + " --trace " + trace_name() + " " + options);
    }

    /// Values of the trace, row by row.
    std::vector<double> values() const {
        std::ifstream in(trace_name(), std::ios::binary);
        std::string head;
        std::getline(in, head);
        const nlohmann::json parsed = nlohmann::json::parse(head);
        std::vector<double> values(parsed["rows"].get<std::size_t>() * parsed["columns"].size());
        in.read(reinterpret_cast<char *>(values.data()),
                static_cast<std::streamsize>(values.size() * sizeof(double)));
        EXPECT_TRUE(in.good());
        return values;
    }

  private:
    std::string name_;
};

/// A record whose counts differ from tick to tick.
std::vector<std::int32_t> lively(std::size_t ticks, std::int32_t step) {
    std::vector<std::int32_t> counts(ticks);
    for (std::size_t i = 0; i < ticks; ++i) {
        counts[i] = static_cast<std::int32_t>(i % 97) * step + static_cast<std::int32_t>(i);
    }
    return counts;
}

TEST(CommandLine, replay_starts_afresh_at_each_record) {
    const std::vector<std::int32_t> first = lively(300, 40);
    const std::vector<std::int32_t> second = lively(300, 900);
    std::vector<std::int32_t> both = first;
    both.insert(both.end(), second.begin(), second.end());
    const std::string columns = "--columns tick,accel_um_s2,rms_um_s2 ";
    std::vector<double> together;
    std::vector<double> alone;
    {
        const CountsFile file(both);
        const Outcome outcome = file.replay(columns + "--record-ticks 300");
        ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
        EXPECT_EQ(nlohmann::json::parse(outcome.output)["records"], 2);
        together = file.values();
    }
    for (const std::vector<std::int32_t> &record : {first, second}) {
        const CountsFile file(record);
        ASSERT_EQ(file.replay(columns).exit_code, 0);
        const std::vector<double> values = file.values();
        alone.insert(alone.end(), values.begin(), values.end());
    }
    EXPECT_EQ(together.size(), 600u * 3u);
    EXPECT_EQ(together, alone);
}

TEST(CommandLine, replay_writes_the_chosen_ticks_of_each_record) {
    const CountsFile file(lively(20, 7));
    const std::string options = "--record-ticks 10 --from-tick 4 --every 3 --columns t_s,tick";
    ASSERT_EQ(file.replay(options).exit_code, 0);
    const std::vector<double> values = file.values();
    const std::vector<double> expected = {0.004, 5, 0.007, 8, 0.004, 5, 0.007, 8};
    EXPECT_EQ(values, expected);
}

TEST(CommandLine, run_writes_the_chosen_columns_and_ticks) {
    const std::string file =
        (std::filesystem::temp_directory_path() / ("quiesce_run_" + std::to_string(::getpid())))
            .string();
    const std::string run =
        "run --scenario sim_hil/data/scenarios/sine_10Hz.toml --law off --trace ";
    ASSERT_EQ(bench(run + file + " --columns t_s,tick --every 2000").exit_code, 0);
    std::ifstream in(file, std::ios::binary);
    std::string head;
    std::getline(in, head);
    std::vector<double> values(8);
    in.read(reinterpret_cast<char *>(values.data()), 8 * sizeof(double));
    std::filesystem::remove(file);
    EXPECT_EQ(nlohmann::json::parse(head)["rows"], 4);
    EXPECT_EQ(values, (std::vector<double>{0.0, 1, 2.0, 2001, 4.0, 4001, 6.0, 6001}));
    EXPECT_NE(bench(run + file + " --columns warp").output.find("no column 'warp'"),
              std::string::npos);
    EXPECT_EQ(bench(run + file + " --every 0").exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(CommandLine, replay_takes_the_least_count_for_a_missing_sample) {
    std::vector<std::int32_t> counts = lively(50, 7);
    counts[20] = counts[21] = INT32_MIN;
    const CountsFile file(counts);
    ASSERT_EQ(file.replay("--columns flags,bad_sample_count").exit_code, 0);
    const std::vector<double> values = file.values();
    const double missing = 2; // enabled
    const double fresh = 3;   // and a sample
    EXPECT_EQ(values[2 * 19], fresh);
    EXPECT_EQ(values[2 * 20], missing);
    EXPECT_EQ(values[2 * 21], missing);
    EXPECT_EQ(values[2 * 22], fresh);
    EXPECT_EQ(values.back(), 2.0);
}

TEST(CommandLine, replay_refuses_records_and_columns_that_do_not_fit) {
    const CountsFile file(lively(20, 7));
    const std::pair<const char *, const char *> calls[] = {
        {"--record-ticks 7", "20 counts are not a whole number of records"},
        {"--record-ticks 0", "--record-ticks 0"},
        {"--record-ticks 10 --from-tick 10", "--from-tick 10"},
        {"--every 21", "--every 21"},
        {"--columns tick,warp", "no column 'warp'"},
        {"--columns ''", "--columns"},
    };
    for (const auto &[options, message] : calls) {
        const Outcome outcome = file.replay(options);
        EXPECT_EQ(outcome.exit_code, 2) << options;
        EXPECT_NE(outcome.output.find(message), std::string::npos) << outcome.output;
        EXPECT_FALSE(std::filesystem::exists(file.trace_name())) << options;
    }
}

TEST(CommandLine, replay_of_recorded_counts_writes_a_trace) {
    const std::string base =
        (std::filesystem::temp_directory_path() / ("quiesce_replay_" + std::to_string(::getpid())))
            .string();
    const char counts[8] = {1, 0, 0, 0, 2, 0, 0, 0};
    std::ofstream(base + ".bin", std::ios::binary).write(counts, sizeof counts);
    const Outcome outcome =
        bench("replay --counts " + base + ".bin --trace " + base + ".trace --law fuzzy");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_EQ(nlohmann::json::parse(outcome.output)["ticks"], 2);
    std::ifstream trace(base + ".trace", std::ios::binary);
    std::string head;
    std::getline(trace, head);
    const nlohmann::json columns = nlohmann::json::parse(head);
    EXPECT_EQ(columns["rows"], 2);
    EXPECT_EQ(columns["columns"][1], "accel_counts");
    std::filesystem::remove(base + ".bin");
    std::filesystem::remove(base + ".trace");
}

} // namespace
