/// quiesce_bench serve: many runs in one process answer what one process each would.
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench_call.h"

using nlohmann::json;
using quiesce::bench;
using quiesce::Outcome;

namespace {

const std::string kData = "sim_hil/data/";

/// Options of run, of plants, dampers, laws, boards and excitations that share as much as they can.
const std::vector<std::string> kRuns = {
    "--scenario " + kData + "scenarios/sine_10Hz.toml --law fuzzy",
    "--scenario " + kData + "scenarios/sine_10Hz.toml --law phase --set adapt=on --seed 7",
    "--scenario " + kData + "scenarios/step_10_20Hz.toml --law fuzzy_selftune",
    "--scenario " + kData + "scenarios/trace_equality.toml --law fuzzy",
    "--scenario " + kData + "scenarios/random_4_22Hz.toml --law phase --seed 3",
    "--scenario " + kData + "scenarios/frame_3dof.toml --law off",
    "--scenario " + kData + "scenarios/base_pulse.toml --law constant",
    "--scenario " + kData + "scenarios/mrd_mre_10Hz.toml --law off",
    "--scenario " + kData + "scenarios/frame_3dof.toml --law fuzzy --board " + kData +
        "boards/squeeze_2012_nodes.toml --plant " + kData + "plants/squeeze_2012_nodes.toml",
};

/// Without what the clock says.
json timeless(const std::string &text) {
    json out = json::parse(text);
    out.erase("wall_s");
    out.erase("realtime_factor");
    return out;
}

/// What serve says to these lines, a line each.
std::vector<std::string> served(const std::string &input) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("quiesce_serve_" + std::to_string(::getpid()));
    std::ofstream(file) << input;
    const Outcome outcome = bench("serve <" + file.string());
    std::filesystem::remove(file);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    std::istringstream lines(outcome.output);
    std::vector<std::string> out;
    for (std::string line; std::getline(lines, line);) {
        out.push_back(line);
    }
    return out;
}

std::string line_of(std::string words) {
    std::replace(words.begin(), words.end(), ' ', '\t');
    return words + "\n";
}

TEST(Serve, answers_what_a_process_each_answers) {
    std::vector<std::string> all = kRuns;
    all.insert(all.end(), kRuns.rbegin(), kRuns.rend()); // each after another one, too
    std::string input;
    for (const std::string &run : all) {
        input += line_of(run);
    }
    const std::vector<std::string> answers = served(input);
    ASSERT_EQ(answers.size(), all.size());
    for (std::size_t i = 0; i < kRuns.size(); ++i) {
        const Outcome alone = bench("run " + kRuns[i]);
        ASSERT_EQ(alone.exit_code, 0) << kRuns[i] << alone.output;
        const json expected = timeless(json_text(alone));
        EXPECT_EQ(timeless(answers[i]), expected) << kRuns[i];
        EXPECT_EQ(timeless(answers[all.size() - 1 - i]), expected) << kRuns[i];
    }
}

TEST(Serve, refuses_a_line_and_goes_on) {
    const std::vector<std::string> answers =
        served("\n" + line_of("--scenario no.toml --law off") + line_of("fly --law") +
               line_of(kRuns[0] + " --set warp=9") + line_of(kRuns[0]));
    ASSERT_EQ(answers.size(), 5u);
    const std::vector<std::string> reasons = {"--scenario is missing", "no.toml", "--law needs",
                                              "warp"};
    for (std::size_t i = 0; i < reasons.size(); ++i) {
        const std::string refused = json::parse(answers[i]).at("refused");
        EXPECT_NE(refused.find(reasons[i]), std::string::npos) << refused;
    }
    EXPECT_EQ(json::parse(answers[4]).at("law"), "fuzzy");
}

TEST(Serve, takes_no_options) {
    EXPECT_EQ(bench("serve --seed 1 </dev/null").exit_code, 2);
    EXPECT_EQ(bench("serve 1 </dev/null").exit_code, 2);
}

} // namespace
