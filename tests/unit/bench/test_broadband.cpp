/// Runs whose excitation has no one frequency, as a user calls them.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "bench_call.h"

namespace {

using nlohmann::json;
using quiesce::bench;
using quiesce::Outcome;

json run(const std::string &scenario, const std::string &options) {
    const Outcome outcome =
        bench("run --scenario sim_hil/data/scenarios/" + scenario + ".toml " + options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    return json::parse(quiesce::json_text(outcome));
}

const std::string kOff = "--law off";
const std::string kFull = "--law constant --set constant_current_mA=5000";

/// At 0 A, where the plant is linear: from another solver, fed with the excitation's formula.
struct Expected {
    const char *scenario;
    double rms_um;
    double peak_um;
    double accel_rms_mm_s2;
};

void PrintTo(const Expected &expected, std::ostream *out) {
    *out << expected.scenario;
}

class Broadband : public testing::TestWithParam<Expected> {};

TEST_P(Broadband, has_no_amplitude_but_everything_else) {
    const json off = run(GetParam().scenario, kOff);
    EXPECT_EQ(off["freq_hz"], 0.0);
    EXPECT_TRUE(off["amp_um"].is_null());
    EXPECT_NEAR(off["disp_rms_um"].get<double>() / GetParam().rms_um, 1.0, 1e-4);
    EXPECT_NEAR(off["peak_disp_um"].get<double>() / GetParam().peak_um, 1.0, 1e-3);
    EXPECT_NEAR(off["accel_rms_mm_s2"].get<double>() / GetParam().accel_rms_mm_s2, 1.0, 1e-3);
    EXPECT_EQ(off["disp_rms_um"], off["rms_disp_um"]);
    EXPECT_TRUE(off["disp_rms2_um"].is_null());
    EXPECT_TRUE(off["transient_peak_disp_um"].is_null());
    const json full = run(GetParam().scenario, kFull);
    EXPECT_LT(full["disp_rms_um"], off["disp_rms_um"]);
    EXPECT_LT(full["damper_work_J"], 10.0 * off["damper_work_J"].get<double>())
        << "a damper takes energy, more with current";
}

TEST_P(Broadband, repeats_itself) {
    json first = run(GetParam().scenario, "--law fuzzy");
    json again = run(GetParam().scenario, "--law fuzzy");
    for (json *out : {&first, &again}) {
        out->erase("wall_s");
        out->erase("realtime_factor");
    }
    EXPECT_EQ(first, again);
}

INSTANTIATE_TEST_SUITE_P(Shipped, Broadband,
                         testing::Values(Expected{"two_tones", 45.8424, 90.628, 253.908},
                                         Expected{"random_4_22Hz", 49.4527, 188.109, 249.157},
                                         Expected{"impulse", 9.23325, 77.664, 67.7285},
                                         Expected{"base_pulse", 22.7028, 163.587, 121.818}),
                         [](const auto &test) { return std::string(test.param.scenario); });

TEST(Windows, are_listed_and_the_first_two_stand_beside_the_run) {
    const json out = run("step_10_20Hz", kOff);
    ASSERT_EQ(out["windows"].size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const std::string number = i == 0 ? "" : "2";
        const json &window = out["windows"][i];
        EXPECT_EQ(window["freq_hz"], out["freq" + number + "_hz"]);
        EXPECT_EQ(window["amp_um"], out["amp" + number + "_um"]);
        EXPECT_EQ(window["disp_rms_um"], out["disp_rms" + number + "_um"]);
        EXPECT_EQ(window["peak_disp_um"], out["peak_disp" + number + "_um"]);
        EXPECT_EQ(window["accel_rms_mm_s2"], out["accel_rms" + number + "_mm_s2"]);
        // A steady sine's peak is its amplitude, and sqrt(2) times its RMS.
        EXPECT_NEAR(window["peak_disp_um"].get<double>() / window["amp_um"].get<double>(), 1.0,
                    1e-3);
        EXPECT_NEAR(window["disp_rms_um"].get<double>() / window["amp_um"].get<double>(),
                    std::sqrt(0.5), 1e-3);
    }
    EXPECT_EQ(out["windows"][0]["start_s"], 2.0);
    EXPECT_EQ(out["windows"][1]["end_s"], 10.0);
    EXPECT_NEAR(out["transient_peak_disp_um"].get<double>(), 138.7, 0.5);
}

/// A file that goes with the object.
class Written {
  public:
    Written(const std::string &ending, const std::string &text)
        : path_((std::filesystem::temp_directory_path() /
                 ("quiesce_broadband_" + std::to_string(::getpid()) + ending))
                    .string()) {
        std::ofstream(path_) << text;
    }
    ~Written() { std::filesystem::remove(path_); }
    Written(const Written &) = delete;
    Written &operator=(const Written &) = delete;

    const std::string &path() const { return path_; }

  private:
    std::string path_;
};

TEST(Windows, may_be_eight) {
    std::string text;
    for (int i = 0; i < 8; ++i) {
        text += "[[window]]\nstart_s = " + std::to_string(i) + "\nend_s = 8\n";
    }
    const Written scenario(
        ".toml", "schema = \"quiesce-scenario\"\nversion = 1\nname = \"x\"\nduration_s = 8\n"
                 "plant = \"" +
                     std::filesystem::absolute("sim_hil/data/plants/squeeze_2012.toml").string() +
                     "\"\n[[segment]]\nkind = \"sine\"\nfreq_Hz = 10\n" + text);
    const Outcome outcome = bench("run --scenario " + scenario.path() + " " + kFull);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const json out = json::parse(quiesce::json_text(outcome));
    ASSERT_EQ(out["windows"].size(), 8u);
    EXPECT_EQ(out["amp_um"], out["windows"][0]["amp_um"]);
    EXPECT_EQ(out["amp2_um"], out["windows"][1]["amp_um"]);
    EXPECT_EQ(out["mean_current_A"], out["windows"][7]["mean_current_A"]);
    EXPECT_EQ(out["rms_disp_um"], out["windows"][7]["disp_rms_um"]);
    EXPECT_EQ(out["damper_work_J"], out["windows"][7]["damper_work_J"]);
    EXPECT_LT(out["windows"][0]["mean_current_A"], out["windows"][7]["mean_current_A"]);
}

TEST(BaseMotion, is_refused_where_the_plant_cannot_feel_it) {
    std::ifstream in("sim_hil/data/plants/squeeze_2012.toml");
    std::ostringstream text;
    for (std::string line; std::getline(in, line);) {
        text << (line.rfind("base_participation", 0) == 0 ? "" : line) << '\n';
    }
    const Written plant(".plant.toml", text.str());
    const Outcome outcome = bench("run --scenario sim_hil/data/scenarios/base_pulse.toml --law off "
                                  "--plant " +
                                  plant.path());
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.output.find("no base_participation"), std::string::npos) << outcome.output;
    EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << outcome.output;
}

TEST(Checks, show_what_shakes_and_what_the_base_does) {
    EXPECT_NE(bench("scenario-check sim_hil/data/scenarios/two_tones.toml")
                  .output.find("tones, 6.3 Hz at 0.05 V + 13.1 Hz at 0.05 V"),
              std::string::npos);
    EXPECT_NE(
        bench("plant-check sim_hil/data/plants/squeeze_2012.toml").output.find("base 0.19 kg^1/2"),
        std::string::npos);
}

} // namespace
