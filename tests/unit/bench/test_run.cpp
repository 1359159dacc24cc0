#include "run.h"

#include <gtest/gtest.h>

#include "crc32.h"
#include "digest.h"
#include "in_process_link.h"
#include "plant_file.h"
#include "scripted_link.h"

namespace {

using quiesce::FaultKind;
using quiesce::RunSetup;
using quiesce::TickRecord;

RunSetup short_setup() {
    RunSetup setup{};
    setup.scenario = quiesce::load_scenario("sim_hil/data/scenarios/sine_10Hz.toml");
    setup.scenario.duration_s = 0.5;
    setup.plant = quiesce::load_plant(setup.scenario.plant_file);
    quiesce_params_default(&setup.params);
    setup.seed = 1;
    return setup;
}

/// Everything that a tick shows, kept.
class Recorder final : public quiesce::TickObserver {
  public:
    void on_tick(const TickRecord &record) override {
        stimuli.push_back(record.stimulus);
        coil_A.push_back(record.truth.coil_A);
    }

    std::vector<lockstep_stimulus_t> stimuli;
    std::vector<double> coil_A;
};

Recorder recorded(const RunSetup &setup, quiesce::ControllerLink &link) {
    Recorder recorder;
    run_scenario(setup, link, {&recorder});
    return recorder;
}

TEST(Run, a_command_acts_from_the_next_tick_on) {
    RunSetup setup = short_setup();
    setup.plant.dampers[0].coil = {0.0, 0.0}; // the coil shows the driver's output at once
    int tick = 0;
    quiesce::ScriptedLink link(
        [&tick](const lockstep_stimulus_t &) { return tick++ == 10 ? 5000 : 0; });
    const Recorder seen = recorded(setup, link);
    for (std::size_t i = 0; i < 30; ++i) {
        // Answered in tick 10, driven from the start of tick 11, all of it: seen at its end.
        ASSERT_NEAR(seen.coil_A[i], i == 12 ? 5.0 : 0.0, 1e-9) << "tick " << i;
    }
}

TEST(Run, ticks_are_duration_times_rate) {
    RunSetup setup = short_setup();
    quiesce::ScriptedLink link = quiesce::constant_link(0);
    EXPECT_EQ(recorded(setup, link).stimuli.size(), 500u);
    setup.params.tick_rate_Hz = 4000;
    EXPECT_EQ(recorded(setup, link).stimuli.size(), 2000u);
}

TEST(Run, same_seed_same_samples_other_seed_others) {
    RunSetup setup = short_setup();
    quiesce::ScriptedLink link = quiesce::constant_link(2500);
    const Recorder first = recorded(setup, link);
    const Recorder again = recorded(setup, link);
    setup.seed = 2;
    const Recorder other = recorded(setup, link);
    std::size_t equal = 0;
    for (std::size_t i = 0; i < first.stimuli.size(); ++i) {
        ASSERT_EQ(first.stimuli[i].counts[0], again.stimuli[i].counts[0]);
        equal += first.stimuli[i].counts[0] == other.stimuli[i].counts[0] ? 1u : 0u;
    }
    EXPECT_LT(equal, first.stimuli.size() / 4);
}

TEST(Run, measured_current_is_fed_back_only_when_asked_for) {
    RunSetup setup = short_setup();
    quiesce::ScriptedLink link = quiesce::constant_link(3000);
    EXPECT_EQ(recorded(setup, link).stimuli.back().flags & LOCKSTEP_HAS_CURRENT, 0u);
    setup.scenario.feed_current = true;
    const lockstep_stimulus_t last = recorded(setup, link).stimuli.back();
    EXPECT_NE(last.flags & LOCKSTEP_HAS_CURRENT, 0u);
    EXPECT_NEAR(last.current_meas_mA[0], 3000, 2);
}

TEST(Run, an_open_coil_is_measured_as_no_current) {
    RunSetup setup = short_setup();
    setup.scenario.feed_current = true;
    setup.scenario.faults = {{FaultKind::coil_open, 0.2, 0.1}};
    quiesce::ScriptedLink link = quiesce::constant_link(3000);
    const Recorder seen = recorded(setup, link);
    EXPECT_NEAR(seen.stimuli[199].current_meas_mA[0], 3000, 2);
    EXPECT_EQ(seen.stimuli[200].current_meas_mA[0], 0);
    EXPECT_EQ(seen.stimuli[299].current_meas_mA[0], 0);
    EXPECT_GT(seen.stimuli[320].current_meas_mA[0], 2500);
}

TEST(Run, a_disabled_driver_gives_no_current) {
    class Disabled final : public quiesce::ControllerLink {
      public:
        std::string target() const override { return "disabled"; }
        quiesce::StartAnswer start(const quiesce_board_t * /*board*/,
                                   const quiesce_params_t & /*params*/,
                                   const quiesce::Tables & /*tables*/) override {
            return {true};
        }
        void exchange(const lockstep_stimulus_t & /*in*/, lockstep_reply_t &reply) override {
            reply = lockstep_reply_t{};
            reply.current_cmd_mA[0] = 5000;
        }
        std::optional<quiesce::InstructionCounts> finish() override { return std::nullopt; }
    };
    Disabled link;
    EXPECT_EQ(recorded(short_setup(), link).coil_A.back(), 0.0);
}

TEST(Run, the_controller_in_process_repeats_itself_bit_for_bit) {
    const RunSetup setup = short_setup();
    quiesce::InProcessLink link;
    quiesce::DigestObserver first;
    quiesce::DigestObserver again;
    run_scenario(setup, link, {&first});
    run_scenario(setup, link, {&again});
    EXPECT_EQ(first.telemetry_crc32(), again.telemetry_crc32());
    EXPECT_EQ(first.distinct_commands(), again.distinct_commands());
}

TEST(Run, refused_parameters_are_reported) {
    RunSetup setup = short_setup();
    setup.params.max_current_mA = -1;
    quiesce::InProcessLink link;
    EXPECT_THROW(run_scenario(setup, link, {}), std::runtime_error);
}

TEST(Crc32, is_zlibs) {
    const std::uint32_t words[] = {0x34333231u, 0x38373635u, 0x34333231u}; // "123456781234"
    quiesce::Crc32 one;
    one.append(words, 1);
    EXPECT_EQ(one.value(), 0x9BE3E0A3u); // "1234"
    quiesce::Crc32 two;
    two.append(words, 2);
    EXPECT_EQ(two.value(), 0x9AE0DAAFu); // "12345678"
    quiesce::Crc32 three;
    three.append(words, 3);
    quiesce::Crc32 in_parts;
    in_parts.append(words, 1);
    in_parts.append(words + 1, 2);
    EXPECT_EQ(three.value(), in_parts.value());
}

} // namespace
