/// What rules and pulses cover, where a run was, and what is said of the difference.
#include "visits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>

#include "bench_call.h"
#include "file_mistakes.h"

extern "C" {
#include "plant_pulses.h"
}

#include "plant_rules.h"

namespace {

using quiesce::bench;
using quiesce::Outcome;
using quiesce::range_of;
using quiesce::Span;
using quiesce::Spread;
using quiesce::TableRange;
using quiesce::VisitObserver;

constexpr std::int32_t kDisplacement = 0, kBalanced = 1;

TEST(TableRange, of_rules_goes_from_the_first_sets_top_to_the_last_ones) {
    const auto range = range_of(plant_rules_table, kBalanced);
    ASSERT_TRUE(range && range->freq_Hz && range->rms_m_s2);
    EXPECT_EQ(range->kind, "rules");
    EXPECT_NEAR(range->freq_Hz->low, 5.0, 1e-5);
    EXPECT_NEAR(range->freq_Hz->high, 20.0, 1e-5);
    EXPECT_GT(range->rms_m_s2->low, 0.0);
    EXPECT_GT(range->rms_m_s2->high, 2.0 * range->rms_m_s2->low);
}

TEST(TableRange, of_pulses_goes_from_the_first_point_to_the_last) {
    for (const std::int32_t setting : {kDisplacement, kBalanced}) {
        const auto range = range_of(plant_pulses_table, setting);
        ASSERT_TRUE(range && range->freq_Hz);
        EXPECT_EQ(range->kind, "pulses");
        EXPECT_NEAR(range->freq_Hz->low, 4.0, 1e-9);
        EXPECT_GT(range->freq_Hz->high, 20.0);
        EXPECT_FALSE(range->rms_m_s2);
    }
}

TEST(TableRange, of_other_tables_is_not_told) {
    const std::uint32_t linear[16] = {0x314E4C51};
    EXPECT_FALSE(range_of(linear, kBalanced));
}

TEST(Spread, tells_most_of_its_values_and_those_outside) {
    Spread spread;
    for (int i = 0; i < 900; ++i) {
        spread.add(10.0);
    }
    for (int i = 0; i < 100; ++i) {
        spread.add(3.0);
    }
    EXPECT_NEAR(spread.most().low, 3.0, 0.03);
    EXPECT_NEAR(spread.most().high, 10.0, 0.1);
    EXPECT_FALSE(spread.outside({2.0, 11.0}));
    const auto outside = spread.outside({5.0, 20.0});
    ASSERT_TRUE(outside);
    EXPECT_NEAR(outside->part, 0.1, 1e-9);
    EXPECT_NEAR(outside->most.high, 3.0, 0.03);
    spread.add(0.0);
    EXPECT_EQ(spread.count(), 1001) << "0 has no logarithm, and is counted";
}

/// Ticks of a run in which a law was at work.
VisitObserver visited(double freq_Hz, double rms_m_s2, std::int32_t current_mA,
                      std::uint32_t state = QUIESCE_STATE_RUN, bool is_known = true) {
    constexpr int kTicks = 1000;
    quiesce_telemetry_t now{};
    now.state = state;
    now.freq_is_valid = is_known ? 1 : 0;
    now.freq_uHz = static_cast<std::int32_t>(1e6 * freq_Hz);
    now.rms_um_s2 = static_cast<std::int32_t>(1e6 * rms_m_s2);
    now.current_law_mA = current_mA;
    VisitObserver visits;
    for (int tick = 0; tick < kTicks; ++tick) {
        visits.add(tick, now);
    }
    return visits;
}

const TableRange kRange{"rules", Span{5.0, 20.0}, Span{1.0, 9.0}};

TEST(Warnings, say_nothing_of_a_run_that_is_covered) {
    EXPECT_TRUE(warnings_of(kRange, visited(5.0, 2.0, 100)).empty());
    EXPECT_TRUE(warnings_of(kRange, visited(4.9, 0.5, 100)).empty()) << "an estimate's noise";
    EXPECT_TRUE(warnings_of(kRange, VisitObserver()).empty()) << "nothing is known of it";
}

TEST(Warnings, name_what_is_covered_and_where_the_run_is) {
    const auto warnings = warnings_of(kRange, visited(3.0, 20.0, 100));
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_EQ(warnings[0], "rules cover 5 to 20 Hz; this run is at 3 Hz");
    EXPECT_EQ(warnings[1].substr(0, 42), "rules cover 1 to 9 m/s2 RMS; this run is a");
}

TEST(Warnings, say_where_levels_are_far_below_the_sets) {
    EXPECT_EQ(warnings_of(kRange, visited(10.0, 0.05, 100)).size(), 1u);
}

TEST(Warnings, say_that_no_current_is_asked_for) {
    const auto warnings = warnings_of(kRange, visited(10.0, 2.0, 0));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0], "the rules ask for no current anywhere in this run");
}

TEST(Warnings, say_that_no_frequency_was_found) {
    const auto warnings = warnings_of(kRange, visited(3.0, 2.0, 0, QUIESCE_STATE_RUN, false));
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0], "no frequency was found anywhere in this run, so the rules were never "
                           "asked: a constant current was held");
    EXPECT_TRUE(warnings_of(kRange, visited(3.0, 2.0, 0, QUIESCE_STATE_IDLE, false)).empty());
}

TEST(Warnings, are_of_the_time_in_which_the_law_was_at_work) {
    EXPECT_TRUE(warnings_of(kRange, visited(3.0, 2.0, 0, QUIESCE_STATE_IDLE)).empty());
}

/// A tone on the published rig, with rules or what else its law has.
Outcome run_at(double freq_Hz, const std::string &law) {
    const auto plant = std::filesystem::absolute("sim_hil/data/plants/squeeze_2012.toml").string();
    std::ostringstream text;
    text << "schema = \"quiesce-scenario\"\nversion = 1\nname = \"tone\"\nplant = \"" << plant
         << "\"\nduration_s = 4.0\n[[segment]]\nkind = \"sine\"\nfreq_Hz = " << freq_Hz
         << "\n[[window]]\nstart_s = 3.0\nend_s = 4.0\n";
    const quiesce::TemporaryFile scenario(text.str());
    return bench("run --scenario " + scenario.path() + " --law " + law);
}

nlohmann::json json_of(const Outcome &outcome) {
    return nlohmann::json::parse(quiesce::json_text(outcome));
}

TEST(BenchRun, warns_where_the_shipped_rules_do_not_cover_a_run) {
    const Outcome run = run_at(3.0, "fuzzy");
    EXPECT_EQ(run.exit_code, 0);
    const std::string warning = "rules cover 5 to 20 Hz; this run is at 3 Hz";
    EXPECT_NE(run.output.find("quiesce_bench: warning: " + warning), std::string::npos)
        << run.output;
    const auto json = json_of(run);
    EXPECT_EQ(json["covered"]["kind"], "rules");
    EXPECT_NEAR(json["visited"]["freq_Hz"][1].get<double>(), 3.0, 0.05);
    EXPECT_EQ(json["warnings"][0].get<std::string>(), warning);
}

TEST(BenchRun, says_nothing_where_they_cover_it) {
    EXPECT_TRUE(json_of(run_at(10.0, "fuzzy"))["warnings"].empty());
}

// 1.88 A hold this mass so firmly that nothing is left to find a frequency in.
TEST(BenchRun, warns_where_rules_are_never_asked) {
    const Outcome run =
        bench("run --scenario sim_hil/data/scenarios/suspended_mass_step.toml --law fuzzy");
    EXPECT_EQ(run.exit_code, 0);
    const auto json = json_of(run);
    EXPECT_TRUE(json["visited"]["freq_Hz"].is_null());
    ASSERT_EQ(json["warnings"].size(), 1u);
    EXPECT_EQ(json["warnings"][0].get<std::string>().rfind("no frequency was found", 0), 0u);
}

TEST(BenchRun, has_nothing_to_say_of_laws_without_such_tables) {
    const Outcome run =
        bench("run --scenario sim_hil/data/scenarios/sine_10Hz.toml --law constant");
    const auto json = json_of(run);
    EXPECT_TRUE(json["covered"].is_null());
    EXPECT_TRUE(json["warnings"].empty());
}

} // namespace
