/// Segments as scenario files describe them, and the recordings that they name.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "file_mistakes.h"
#include "scenario.h"

namespace {

using quiesce::expect_message;
using quiesce::InputError;
using quiesce::load_scenario;
using quiesce::Mistake;
using quiesce::Scenario;
using quiesce::spoilt;
using quiesce::TemporaryFile;

constexpr quiesce::ShakerParams kUnit = {1.0, 10.0, 0.0, 1.0};

std::string scenario_text(const std::string &segments) {
    return "schema = \"quiesce-scenario\"\nversion = 1\nname = \"x\"\nplant = \"p.toml\"\n"
           "duration_s = 1\n" +
           segments;
}

const char *const kTones = "[[segment]]\n"
                           "kind = \"tones\"\n"
                           "[[segment.tone]]\n"
                           "freq_Hz = 5\n"
                           "drive_V = 0.1\n"
                           "[[segment.tone]]\n"
                           "freq_Hz = 13\n"
                           "drive_V = 0.2\n"
                           "phase_deg = 90\n";
const char *const kBaseTones = "[[segment]]\n"
                               "kind = \"base_tones\"\n"
                               "[[segment.tone]]\n"
                               "freq_Hz = 10\n"
                               "accel_m_s2 = 3\n"
                               "[[segment.tone]]\n"
                               "freq_Hz = 40\n"
                               "accel_m_s2 = 0.5\n"
                               "phase_deg = 90\n";
const char *const kRandom = "[[segment]]\n"
                            "kind = \"random\"\n"
                            "low_Hz = 4\n"
                            "high_Hz = 22\n"
                            "drive_rms_V = 0.1\n"
                            "seed = 7\n"
                            "duration_s = 20\n";
const char *const kImpulse = "[[segment]]\n"
                             "kind = \"impulse\"\n"
                             "impulse_N_s = 0.01\n"
                             "pulse_s = 0.02\n";

TEST(SegmentFile, tones_random_and_impulse_are_what_it_says) {
    const TemporaryFile file(
        scenario_text(std::string(kRandom) + kImpulse + "duration_s = 2\n" + kTones));
    const Scenario scenario = load_scenario(file.path());
    ASSERT_EQ(scenario.segments.size(), 3u);
    EXPECT_EQ(scenario.segments[0].duration_s, 20.0);
    EXPECT_EQ(scenario.segments[0].summary, "random, 4 .. 22 Hz at 0.1 V RMS, seed 7");
    EXPECT_EQ(scenario.segments[1].summary, "impulse, 0.01 N s in 0.02 s");
    EXPECT_EQ(scenario.segments[2].summary, "tones, 5 Hz at 0.1 V + 13 Hz at 0.2 V");
    EXPECT_FALSE(moves_base(scenario, kUnit));
    const quiesce::Excitation excitation = make_excitation(scenario, kUnit);
    EXPECT_NE(excitation.at(3.0).force_N, 0.0);
    EXPECT_NEAR(excitation.at(20.01).force_N, 0.01 * 1.5707963267948966 / 0.02, 1e-9);
    EXPECT_EQ(excitation.at(21.0).force_N, 0.0);
    EXPECT_NEAR(excitation.at(22.0).force_N, 0.2, 1e-12) << "the second tone begins at its top";
}

TEST(SegmentFile, a_shaker_below_the_base_moves_it_but_not_by_blows) {
    constexpr quiesce::ShakerParams kTable = {1.0, 10.0, 0.0, 1.0, true};
    const TemporaryFile file(scenario_text(std::string(kRandom) + kTones));
    const Scenario scenario = load_scenario(file.path());
    EXPECT_TRUE(moves_base(scenario, kTable));
    const quiesce::Excitation on_it = make_excitation(scenario, kUnit);
    const quiesce::Excitation below = make_excitation(scenario, kTable);
    for (const double time_s : {3.0, 20.3}) {
        EXPECT_EQ(below.at(time_s).force_N, 0.0);
        EXPECT_EQ(below.at(time_s).base_accel_m_s2, on_it.at(time_s).force_N);
    }
    const TemporaryFile blow(scenario_text(kImpulse));
    EXPECT_FALSE(moves_base(load_scenario(blow.path()), kTable));
}

TEST(SegmentFile, base_tones_move_the_base) {
    const TemporaryFile file(scenario_text(kBaseTones));
    const Scenario scenario = load_scenario(file.path());
    EXPECT_EQ(scenario.segments[0].summary, "base tones, 10 Hz at 3 m/s2 + 40 Hz at 0.5 m/s2");
    EXPECT_TRUE(moves_base(scenario, kUnit));
    const quiesce::Excitation excitation = make_excitation(scenario, kUnit);
    EXPECT_NEAR(excitation.at(0.0).base_accel_m_s2, 0.5, 1e-12);
    EXPECT_NEAR(excitation.at(0.025).base_accel_m_s2, 3.0 + 0.5, 1e-12);
    EXPECT_EQ(excitation.at(0.025).force_N, 0.0);
}

class SegmentMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(SegmentMistakes, are_named) {
    const std::string name = GetParam().name;
    const char *const good = name.rfind("tone", 0) == 0     ? kTones
                             : name.rfind("base", 0) == 0   ? kBaseTones
                             : name.rfind("random", 0) == 0 ? kRandom
                                                            : kImpulse;
    expect_message(scenario_text(spoilt(good, GetParam())), GetParam().words, load_scenario);
}

const Mistake kSegmentMistakes[] = {
    {"tones_none",
     "[[segment.tone]]\nfreq_Hz = 5\ndrive_V = 0.1\n[[segment.tone]]\nfreq_Hz = "
     "13\ndrive_V = 0.2\nphase_deg = 90\n",
     "", "segment[1].tone: expected 1 .. 64 tables [[segment.tone]]"},
    {"tones_number", "[[segment.tone]]\nfreq_Hz = 5\ndrive_V = 0.1\n[[segment.tone]]",
     "[segment.tone]", "segment[1].tone: expected tables [[segment[1].tone]]"},
    {"tones_freq", "freq_Hz = 13", "freq_Hz = 0", "segment[1].tone[2].freq_Hz: expected a number"},
    {"tones_no_drive", "drive_V = 0.1\n", "", "segment[1].tone[1].drive_V: missing"},
    {"tones_drive", "drive_V = 0.2", "drive_V = -0.2", "segment[1].tone[2].drive_V: expected"},
    {"tones_phase", "phase_deg = 90", "phase_deg = 900", "segment[1].tone[2].phase_deg: expected"},
    {"tones_unknown", "phase_deg = 90", "phase = 90", "segment[1].tone[2].phase: unknown key"},
    {"base_drive", "accel_m_s2 = 3", "drive_V = 3", "segment[1].tone[1].accel_m_s2: missing"},
    {"base_accel", "accel_m_s2 = 3", "accel_m_s2 = -3", "segment[1].tone[1].accel_m_s2: expected"},
    {"random_low", "low_Hz = 4", "low_Hz = -4", "segment[1].low_Hz: expected a number in 0.001"},
    {"random_backwards", "high_Hz = 22", "high_Hz = 3",
     "segment[1].high_Hz: expected at least 1.001 times low_Hz"},
    {"random_no_drive", "drive_rms_V = 0.1\n", "", "segment[1].drive_rms_V: missing"},
    {"random_drive", "drive_rms_V = 0.1", "drive_rms_V = nan", "segment[1].drive_rms_V: expected"},
    {"random_seed", "seed = 7", "seed = 7.5", "segment[1].seed: expected an integer"},
    {"random_open", "duration_s = 20\n", "", "segment[1].duration_s: missing"},
    {"random_too_long", "duration_s = 20", "duration_s = 50000",
     "segment[1].duration_s: expected at most 4545.45 s"},
    {"random_freq", "seed = 7", "freq_Hz = 7", "segment[1].freq_Hz: unknown key"},
    {"impulse_none", "impulse_N_s = 0.01\n", "", "segment[1].impulse_N_s: missing"},
    {"impulse_text", "impulse_N_s = 0.01", "impulse_N_s = \"x\"",
     "segment[1].impulse_N_s: expected"},
    {"impulse_too_short", "pulse_s = 0.02", "pulse_s = 0.0001", "segment[1].pulse_s: expected"},
    {"impulse_too_long", "pulse_s = 0.02", "pulse_s = 2\nduration_s = 1",
     "segment[1].pulse_s: expected no more than duration_s"},
};
INSTANTIATE_TEST_SUITE_P(ScenarioFile, SegmentMistakes, testing::ValuesIn(kSegmentMistakes),
                         [](const auto &test) { return std::string(test.param.name); });

std::string record_text(const std::string &csv, const std::string &more = "") {
    return scenario_text("[[segment]]\nkind = \"record\"\nfile = \"" + csv +
                         "\"\ntime_column = \"t_s\"\naccel_column = \"a_g\"\n" + more);
}

std::string file_name(const TemporaryFile &file) {
    return std::filesystem::path(file.path()).filename().string();
}

TEST(RecordFile, beside_the_scenario_is_scaled_and_sped_up) {
    const TemporaryFile csv("\xEF\xBB\xBFnote, t_s ,a_g\r\n#1,0.5,0.1\r\nx y,1.5,-0.3\r\n\r\n",
                            ".csv");
    const TemporaryFile file(
        record_text(file_name(csv), "scale_m_s2 = 9.80665\ngain = 0.5\ntime_scale = 2\n"));
    const Scenario scenario = load_scenario(file.path());
    EXPECT_TRUE(moves_base(scenario, kUnit));
    const quiesce::Excitation excitation = make_excitation(scenario, kUnit);
    EXPECT_NEAR(excitation.at(0.0).base_accel_m_s2, 0.05 * 9.80665, 1e-12);
    EXPECT_NEAR(excitation.at(0.25).base_accel_m_s2, -0.05 * 9.80665, 1e-12);
    EXPECT_NEAR(excitation.at(0.5).base_accel_m_s2, -0.15 * 9.80665, 1e-12);
    EXPECT_EQ(excitation.at(0.51).base_accel_m_s2, 0.0);
    EXPECT_EQ(excitation.at(0.25).force_N, 0.0);
}

TEST(RecordFile, may_have_an_absolute_path) {
    const TemporaryFile csv("t_s,a_g\n0,1\n1,1\n", ".csv");
    const TemporaryFile file(record_text(csv.path()));
    EXPECT_EQ(make_excitation(load_scenario(file.path()), kUnit).at(0.5).base_accel_m_s2, 1.0);
}

TEST(RecordFile, measured_earthquakes_load_with_their_peaks) {
    const std::string folder =
        std::filesystem::absolute("../shared/data/earthquake").lexically_normal().string();
    if (!std::filesystem::exists(folder)) {
        GTEST_SKIP() << "recordings are not beside the project";
    }
    const std::pair<const char *, double> records[] = {{"el_centro_1940_ns", 3.42},
                                                       {"kobe_1995", 6.33}};
    for (const auto &[name, peak_m_s2] : records) {
        std::string text = record_text(folder + "/" + name + ".csv");
        text.replace(text.find("a_g"), 3, "acc_m_s2");
        const TemporaryFile file(text);
        const quiesce::Excitation excitation = make_excitation(load_scenario(file.path()), kUnit);
        double found_m_s2 = 0.0;
        for (int i = 0; i < 60000; ++i) {
            found_m_s2 = std::max(found_m_s2, std::abs(excitation.at(i * 1e-3).base_accel_m_s2));
        }
        EXPECT_NEAR(found_m_s2, peak_m_s2, 0.005) << name;
    }
}

TEST(RecordFile, that_is_not_there_is_named_with_the_scenarios_line) {
    expect_message(record_text("no.csv"), ":8: segment[1].file: there is no file ", load_scenario);
    expect_message(record_text("."), "segment[1].file: there is no file ", load_scenario);
}

const Mistake kRecordKeys[] = {
    {"no_time_column", "time_column = \"t_s\"\n", "", "segment[1].time_column: missing"},
    {"no_accel_column", "accel_column = \"a_g\"\n", "", "segment[1].accel_column: missing"},
    {"zero_scale", "\"a_g\"\n", "\"a_g\"\nscale_m_s2 = 0\n", "segment[1].scale_m_s2: expected"},
    {"gain_text", "\"a_g\"\n", "\"a_g\"\ngain = \"2\"\n", "segment[1].gain: expected a number"},
    {"no_time", "\"a_g\"\n", "\"a_g\"\ntime_scale = 0\n", "segment[1].time_scale: expected"},
    {"unknown", "\"a_g\"\n", "\"a_g\"\nspeed = 5\n", "segment[1].speed: unknown key"},
};

TEST(RecordFile, keys_that_are_wrong_are_named) {
    const TemporaryFile csv("t_s,a_g\n0,1\n1,1\n", ".csv");
    for (const Mistake &mistake : kRecordKeys) {
        SCOPED_TRACE(mistake.name);
        expect_message(spoilt(record_text(file_name(csv)), mistake), mistake.words, load_scenario);
    }
}

struct BadCsv {
    const char *name;
    const char *text;
    const char *words; ///< after the name of the file
};

const BadCsv kBadCsv[] = {
    {"empty", "", ":1: cannot be read, or is empty"},
    {"no_such_column", "t_s,a\n0,1\n1,1\n", ":1: no column 'a_g'; there are: t_s, a"},
    {"text", "t_s,a_g\n0,1\n1,fast\n", ":3: a_g: expected a finite number, found 'fast'"},
    {"half_a_number", "t_s,a_g\n0,1\n1,1.5.2\n", ":3: a_g: expected a finite number"},
    {"nan", "t_s,a_g\n0,1\n1,nan\n", ":3: a_g: expected a finite number, found 'nan'"},
    {"infinite_time", "t_s,a_g\n0,1\ninf,1\n", ":3: t_s: expected a finite number, found 'inf'"},
    {"short_row", "t_s,a_g\n0,1\n1\n", ":3: a_g: expected a finite number, found ''"},
    {"times_stand_still", "t_s,a_g\n0,1\n\n0,2\n", ":4: t_s: expected rising times, found 0"},
    {"times_fall", "t_s,a_g\n0,1\n1,2\n0.5,2\n", ":4: t_s: expected rising times, found 0.5 after"},
    {"one_row", "t_s,a_g\n0,1\n", ":1: expected at least two rows"},
};

TEST(RecordFile, with_bad_rows_is_named_with_its_line) {
    for (const BadCsv &bad : kBadCsv) {
        SCOPED_TRACE(bad.name);
        const TemporaryFile csv(bad.text, ".csv");
        const TemporaryFile file(record_text(file_name(csv)));
        try {
            load_scenario(file.path());
            FAIL() << "accepted";
        } catch (const InputError &error) {
            EXPECT_EQ(std::string(error.what()).rfind(csv.path() + bad.words, 0), 0u)
                << error.what();
        }
    }
}

} // namespace
