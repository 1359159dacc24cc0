/// The rig in the computer: its clock, what is measured, what a user may change meanwhile.
#include <gtest/gtest.h>

#include "in_process_link.h"
#include "input_error.h"
#include "live_session.h"
#include "node_link.h"
#include "plant_file.h"

namespace quiesce {
namespace {

constexpr std::int64_t kTick_ns = 1'000'000;
constexpr const char *kSine10 = "sim_hil/data/scenarios/sine_10Hz.toml";

RunSetup setup_of_file(const std::string &scenario) {
    RunSetup setup{};
    setup.scenario = load_scenario(scenario);
    setup.plant = load_plant(setup.scenario.plant_file);
    quiesce_params_default(&setup.params);
    setup.seed = 1;
    return setup;
}

/// A session whose clock the test advances, exactly on time.
struct LiveRig {
    explicit LiveRig(RunSetup setup = setup_of_file(kSine10))
        : session(std::move(setup), link, true, 0) {}

    void run(std::int64_t ticks) {
        for (std::int64_t i = 0; i < ticks; ++i) {
            session.tick(session.pace().due_ns());
        }
    }

    Json state(const std::string &key) const { return session.state().at(key); }
    std::string crc() const { return session.summary().at("telemetry_crc32").dump(); }

    NodeLink link{make_node_here(), nullptr};
    LiveSession session;
};

std::string lock_step_crc(const RunSetup &setup) {
    InProcessLink link;
    DigestObserver digest;
    run_scenario(setup, link, {&digest});
    return std::to_string(digest.telemetry_crc32());
}

TEST(Pace, ticks_are_due_at_exact_multiples_of_a_period_that_is_no_whole_number) {
    Pace pace(3000, 500);
    for (int i = 0; i < 3000; ++i) {
        pace.begin(pace.due_ns());
    }
    EXPECT_EQ(pace.due_ns(), 500 + 1'000'000'000);
    EXPECT_EQ(pace.ticks(), 3000);
    EXPECT_EQ(pace.overruns(), 0u);
    EXPECT_EQ(pace.histogram()[0], 3000u);
}

TEST(Pace, late_ticks_are_counted_by_how_late_and_made_up_for) {
    Pace pace(1000, 0);
    pace.begin(0);
    pace.begin(kTick_ns + 5'000);       // 5 us: bin 3, less than 8
    pace.begin(2 * kTick_ns + 999'000); // not yet a tick
    EXPECT_EQ(pace.overruns(), 0u);
    pace.begin(5 * kTick_ns); // due at 3 ms
    EXPECT_EQ(pace.overruns(), 1u);
    EXPECT_EQ(pace.lateness_us(), 2000);
    EXPECT_EQ(pace.due_ns(), 4 * kTick_ns);
    EXPECT_EQ(pace.histogram()[0], 1u);
    EXPECT_EQ(pace.histogram()[3], 1u);
    EXPECT_EQ(pace.histogram()[10], 1u);
    EXPECT_EQ(pace.histogram()[11], 1u);
    EXPECT_EQ(pace.latest_us(), 2000);
    EXPECT_EQ(pace.lost_s(), 0.0);
}

TEST(Pace, what_is_due_can_be_shifted) {
    Pace pace(1000, 0);
    pace.begin(0);
    EXPECT_EQ(pace.half_way_ns(), kTick_ns / 2);
    pace.shift(-5'000);
    EXPECT_EQ(pace.due_ns(), kTick_ns - 5'000);
    pace.begin(pace.due_ns());
    pace.shift(7'000);
    EXPECT_EQ(pace.due_ns(), 2 * kTick_ns + 2'000);
    EXPECT_EQ(pace.overruns(), 0u);
}

TEST(Pace, what_is_far_too_late_is_given_up) {
    Pace pace(1000, 0);
    pace.begin(3'000'000'000);
    EXPECT_EQ(pace.lost_s(), 3.0);
    EXPECT_EQ(pace.due_ns(), 3'000'000'000 + kTick_ns);
    EXPECT_EQ(pace.histogram()[Pace::kBins - 1], 1u);
}

TEST(Pace, another_rate_goes_on_from_the_tick_under_way) {
    Pace pace(1000, 0);
    pace.begin(0);
    pace.change_rate(4000, 0);
    EXPECT_EQ(pace.due_ns(), 250'000);
    EXPECT_EQ(pace.ticks(), 1);
}

TEST(Live, gives_the_bits_of_lock_step) {
    for (const char *file : {kSine10, "sim_hil/data/scenarios/trace_equality.toml"}) {
        const RunSetup setup = setup_of_file(file);
        LiveRig rig(setup);
        rig.run(setup.tick_count());
        EXPECT_EQ(rig.crc(), lock_step_crc(setup)) << file;
    }
}

TEST(Live, orders_give_the_bits_of_a_scenario_that_has_them) {
    RunSetup scripted = setup_of_file(kSine10);
    scripted.scenario.duration_s = 4.0;
    scripted.scenario.segments = {lasting_sine(10), lasting_sine(17.5)};
    scripted.scenario.segments[0].duration_s = 1.501; // an order of tick 1500 acts from 1501 on
    scripted.scenario.faults = {{FaultKind::dropout, 2.0, 0.05}, {FaultKind::disable, 3.0, 1.0}};
    LiveRig rig;
    rig.run(1500);
    rig.session.obey(R"(excite = {kind = "sine", freq_Hz = 17.5})");
    rig.run(500);
    rig.session.obey(R"(fault = {kind = "dropout", duration_s = 0.05})");
    rig.run(1000);
    rig.session.obey("control = false");
    rig.run(1000);
    EXPECT_EQ(rig.crc(), lock_step_crc(scripted));
}

TEST(Live, what_is_refused_changes_nothing) {
    LiveRig rig;
    rig.run(10);
    const std::string before = rig.session.state().dump();
    for (const char *order :
         {"control = 1", "control = false, speed = 2", "control = false\ndrive_V = 1",
          "drive_V = -1", "drive_V = nan", "excite = 3", R"(excite = {kind = "waltz"})",
          R"(control = false, excite = {kind = "sine", freq_Hz = 0})",
          R"(excite = {kind = "record", file = "none.csv", time_column = "t", accel_column = "a"})",
          R"(fault = {kind = "coil_open"})",
          R"(fault = {kind = "coil_open", duration_s = 1, t_s = 2})",
          R"(fault = {kind = "dropout", duration_s = 1, of = "nobody"})", "[[", "control", "}",
          "control = false}\nwrong = {"}) {
        EXPECT_THROW(rig.session.obey(order), InputError) << order;
        EXPECT_EQ(rig.session.state().dump(), before) << order;
    }
    rig.session.obey(""); // asks for nothing
}

TEST(Live, a_base_that_nothing_feels_is_not_shaken) {
    RunSetup setup = setup_of_file(kSine10);
    setup.plant.structure.base_participation.setZero();
    LiveRig rig(setup);
    const std::string pulse =
        R"(excite = {kind = "record", file = "sim_hil/data/recordings/base_pulse.csv", )"
        R"(time_column = "time_s", accel_column = "base_g", gain = 0.05})";
    EXPECT_THROW(rig.session.obey(pulse), InputError);
    LiveRig().session.obey(pulse);
}

TEST(Live, a_drive_that_breaks_the_rig_sets_it_up_again_at_rest) {
    LiveRig rig;
    rig.run(100);
    rig.session.obey("drive_V = 1e5");
    rig.run(200);
    EXPECT_NE(rig.state("halt").dump().find("closed to the end of its range"), std::string::npos);
    EXPECT_EQ(rig.state("drive_V").dump(), "0.0");
    EXPECT_EQ(rig.state("control").dump(), "true");
    EXPECT_EQ(rig.state("ticks").dump(), "300");
    rig.session.obey("drive_V = 0.1");
    rig.run(1000);
    EXPECT_EQ(rig.state("halt").dump(), "\"\"");
    EXPECT_NE(rig.state("vibration").at("now").at("displacement_um").dump(), "0.0");
}

TEST(Live, faults_are_present_until_they_end_or_are_called_off) {
    LiveRig rig;
    rig.session.obey(R"(fault = {kind = "coil_open", duration_s = 0.1})");
    rig.session.obey(R"(fault = {kind = "stuck", duration_s = 100})");
    rig.run(50);
    EXPECT_EQ(rig.state("faults").dump(), R"(["stuck","coil_open"])");
    rig.run(60);
    EXPECT_EQ(rig.state("faults").dump(), R"(["stuck"])");
    rig.session.obey("clear_faults = true");
    EXPECT_EQ(rig.state("faults").dump(), "[]");
}

double um(const Json &rms) {
    return std::stod(rms.at("displacement_um").dump());
}

TEST(Live, vibration_is_compared_with_and_without_control_under_one_excitation) {
    RunSetup setup = setup_of_file(kSine10);
    setup.params.law = QUIESCE_LAW_PHASE;
    LiveRig rig(setup);
    rig.run(4000);
    EXPECT_EQ(rig.state("vibration").at("off").dump(), "null");
    rig.session.obey("control = false");
    rig.run(4000);
    const Json measured = rig.state("vibration");
    EXPECT_LT(um(measured.at("on")), 0.9 * um(measured.at("off")));
    rig.session.obey(R"(excite = {kind = "sine", freq_Hz = 12})");
    EXPECT_EQ(rig.state("vibration").at("on").dump(), "null");
    EXPECT_EQ(rig.state("vibration").at("off").dump(), "null");
}

/// What the plant's own accelerometer reads at rest, in counts.
std::int32_t counts_at_rest(double gravity_m_s2) {
    RunSetup setup = setup_of_file(kSine10);
    setup.plant.shaker.drive_V = 0.0;
    setup.plant.sensor.noise_mg = 0.0;
    setup.plant.sensor.offset_counts = 300;
    const Excitation excitation = make_excitation(setup.scenario, setup.plant.shaker);
    const Plant plant(setup.plant, excitation, setup.params.tick_rate_Hz);
    Senses senses(setup.plant, nullptr, setup.params.tick_rate_Hz, setup.seed);
    senses.lie(gravity_m_s2);
    lockstep_stimulus_t stimulus{};
    senses.read(plant, 0, stimulus);
    return stimulus.counts[0];
}

TEST(Live, an_accelerometer_that_is_turned_over_reads_gravity) {
    const RunSetup setup = setup_of_file(kSine10);
    const double g_counts = (1 << (setup.plant.sensor.bits - 1)) / setup.plant.sensor.full_scale_g;
    EXPECT_EQ(counts_at_rest(0.0), 300);
    EXPECT_NEAR(counts_at_rest(kGravity_m_s2), 300 + g_counts, 1.0);
    EXPECT_NEAR(counts_at_rest(-kGravity_m_s2), 300 - g_counts, 1.0);
}

TEST(Live, gravity_is_no_motion_of_the_rig) {
    LiveRig rig;
    rig.run(3000);
    const double before_um = um(rig.state("vibration").at("now"));
    rig.session.obey("gravity_g = -1");
    rig.run(10);
    EXPECT_NEAR(um(rig.state("vibration").at("now")), before_um, 0.01 * before_um);
    EXPECT_THROW(rig.session.obey("gravity_g = 1.5"), InputError);
}

} // namespace
} // namespace quiesce
