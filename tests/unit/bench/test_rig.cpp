// A board on a plant: sensors and dampers at their places.
#include "rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "bench_call.h"
#include "in_process_link.h"
#include "input_error.h"
#include "plant_file.h"
#include "rig_metrics.h"
#include "run.h"
#include "scripted_link.h"
#include "warm_damper.h"

namespace {

using quiesce::BoardFile;
using quiesce::FaultKind;
using quiesce::PlantModel;
using quiesce::RunSetup;
using quiesce::TickRecord;

const std::string kScenario = "sim_hil/data/rigs/two_storeys.toml";

PlantModel plant() {
    return quiesce::load_plant("sim_hil/data/plants/two_storeys.toml");
}

BoardFile board() {
    return quiesce::load_board("sim_hil/data/boards/two_storeys.toml");
}

/// With the board and the plant as these change them.
RunSetup setup_with(const std::function<void(BoardFile &)> &change_board = {},
                    const std::function<void(PlantModel &)> &change_plant = {}) {
    RunSetup setup{};
    setup.scenario = quiesce::load_scenario(kScenario);
    setup.scenario.duration_s = 1.0;
    setup.plant = plant();
    if (change_plant) {
        change_plant(setup.plant);
    }
    BoardFile file = board();
    if (change_board) {
        change_board(file);
    }
    setup.rig = quiesce::make_rig(std::move(file), setup.plant);
    quiesce_params_default(&setup.params);
    setup.seed = 1;
    return setup;
}

/// What each tick was like.
struct Seen {
    std::vector<lockstep_stimulus_t> stimuli;
    std::vector<quiesce::PlaceTruth> floor, roof;
    std::vector<quiesce::DamperTruth> lower, upper;
    std::vector<lockstep_reply_t> replies;
};

class Recorder final : public quiesce::TickObserver {
  public:
    explicit Recorder(Seen &seen) : seen_(seen) {}

    void on_tick(const TickRecord &record) override {
        seen_.stimuli.push_back(record.stimulus);
        seen_.replies.push_back(record.reply);
        seen_.floor.push_back(record.plant.place(0));
        seen_.roof.push_back(record.plant.place(1));
        seen_.lower.push_back(record.plant.damper(0));
        seen_.upper.push_back(record.plant.damper(1));
    }

  private:
    Seen &seen_;
};

Seen run(const RunSetup &setup, quiesce::ControllerLink &link) {
    Seen seen;
    Recorder recorder(seen);
    run_scenario(setup, link, {&recorder});
    return seen;
}

Seen run_idle(const RunSetup &setup) {
    quiesce::ScriptedLink link = quiesce::constant_link(0);
    return run(setup, link);
}

std::string refusal(const std::function<void(BoardFile &)> &change_board,
                    const std::function<void(PlantModel &)> &change_plant = {}) {
    try {
        setup_with(change_board, change_plant);
    } catch (const quiesce::InputError &error) {
        return error.what();
    }
    return "nothing is refused";
}

void expect_in(const std::string &part, const std::string &text) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(Rig, what_the_plant_lacks_is_named) {
    expect_in("body 'attic'", refusal([](BoardFile &file) { file.bodies[1] = "attic"; }));
    expect_in("floor, roof", refusal([](BoardFile &file) { file.bodies[1] = "attic"; }));
    expect_in("damper 'side'", refusal([](BoardFile &file) { file.dampers[0] = "side"; }));
    expect_in("sensor 'floor_accel' of the board", refusal([](BoardFile &file) {
                  file.board.sensor[0].sense = QUIESCE_SENSE_TEMPERATURE;
              }));
    expect_in("damper 'upper' of the plant", refusal([](BoardFile &file) {
                  file.dampers.pop_back();
                  file.board.dampers = 1;
              }));
    expect_in("noise.cellar", refusal({}, [](PlantModel &model) { model.noise["cellar"] = 1.0; }));
}

TEST(Rig, ends_are_those_of_the_plant) {
    expect_in("damper 'upper': its ends", refusal([](BoardFile &file) {
                  std::swap(file.board.damper[1].end_a, file.board.damper[1].end_b);
              }));
    expect_in("damper 'lower': its ends",
              refusal([](BoardFile &file) { file.board.damper[0].end_a = 1; }));
}

TEST(Rig, sensors_show_their_places_in_counts) {
    const Seen seen = run_idle(setup_with([](BoardFile &file) {
        file.board.sensor[0].polarity = -1;
        file.board.sensor[1].offset_counts = 700;
    }));
    for (std::size_t i = 0; i < seen.stimuli.size(); i += 37) {
        const std::int32_t *counts = seen.stimuli[i].counts;
        EXPECT_NEAR(counts[0], -1e6 * seen.floor[i].accel_m_s2 / 57.751, 0.51);
        EXPECT_NEAR(counts[1], 700 + 1e6 * seen.roof[i].accel_m_s2 / 57.751, 0.51);
        EXPECT_NEAR(counts[2], 1e9 * seen.upper[i].stroke_m / 1000.0, 0.51);
        const std::uint32_t enable = i > 0 ? LOCKSTEP_ENABLE : 0u; // its edge arms
        EXPECT_EQ(seen.stimuli[i].flags, enable | LOCKSTEP_FRESH * 7u);
        EXPECT_NEAR(seen.upper[i].stroke_m,
                    seen.roof[i].displacement_m - seen.floor[i].displacement_m, 1e-12);
    }
    EXPECT_GT(std::abs(seen.stimuli.back().counts[2]), 100);
}

TEST(Rig, a_warm_fluid_reaches_the_controllers_picture) {
    RunSetup setup = setup_with(
        [](BoardFile &file) {
            file.board.sensor[2].sense = QUIESCE_SENSE_TEMPERATURE;
            file.board.sensor[2].scale = 1000; // a count is 1 mdegC
            file.board.sensor[2].stuck_us = 0;
        },
        [](PlantModel &model) {
            quiesce::PlantDamper &upper = model.dampers[1];
            const quiesce::HeatParams heat{0.5, 0.1, 20.0, 20.0, 0.0};
            upper.damper = std::make_shared<quiesce::WarmDamper>(upper.damper, heat);
        });
    setup.wants_picture = true;
    quiesce::InProcessLink link;
    const Seen seen = run(setup, link);
    for (std::size_t i = 0; i < seen.stimuli.size(); i += 37) {
        EXPECT_FALSE(seen.lower[i].fluid_C.has_value());
        EXPECT_NEAR(seen.stimuli[i].counts[2], 1e3 * *seen.upper[i].fluid_C, 0.51);
        EXPECT_EQ(seen.replies[i].picture.damper[1].temperature_mdegC, seen.stimuli[i].counts[2]);
    }
    EXPECT_GT(*seen.upper.back().fluid_C, 20.01);
}

TEST(Rig, full_scale_limits_and_noise_is_the_plants) {
    const Seen quiet = run_idle(setup_with());
    const Seen noisy = run_idle(
        setup_with([](BoardFile &file) { file.board.sensor[2].full_scale_counts = 2000; },
                   [](PlantModel &model) { model.noise["floor_accel"] = 577.51; })); // 10 counts
    double squares = 0.0;
    for (std::size_t i = 0; i < quiet.stimuli.size(); ++i) {
        const double extra = noisy.stimuli[i].counts[0] - quiet.stimuli[i].counts[0];
        squares += extra * extra;
        EXPECT_EQ(noisy.stimuli[i].counts[1], quiet.stimuli[i].counts[1]);
        EXPECT_LE(std::abs(noisy.stimuli[i].counts[2]), 2000);
    }
    EXPECT_NEAR(std::sqrt(squares / static_cast<double>(quiet.stimuli.size())), 10.0, 1.0);
}

TEST(Rig, a_slow_sensor_has_a_sample_a_period) {
    const Seen seen =
        run_idle(setup_with([](BoardFile &file) { file.board.sensor[2].period_us = 2500; }));
    std::size_t samples = 0;
    for (std::size_t i = 0; i < seen.stimuli.size(); ++i) {
        const bool is_fresh = (seen.stimuli[i].flags & LOCKSTEP_FRESH << 2) != 0;
        samples += is_fresh ? 1 : 0;
        EXPECT_EQ(is_fresh, i * 1000 / 2500 != (i - 1) * 1000 / 2500 || i == 0) << i;
    }
    EXPECT_EQ(samples, 400u);
}

TEST(Rig, a_slow_sensor_is_stuck_at_its_last_sample) {
    RunSetup setup = setup_with([](BoardFile &file) { file.board.sensor[2].period_us = 5000; });
    setup.scenario.faults = {{FaultKind::stuck, 0.5, 0.2, "upper_stroke"}};
    const Seen seen = run_idle(setup);
    EXPECT_NE(seen.stimuli[495].counts[2], 0);
    EXPECT_EQ(seen.stimuli[500].counts[2], seen.stimuli[495].counts[2]);
    EXPECT_EQ(seen.stimuli[690].counts[2], seen.stimuli[495].counts[2]);
}

TEST(Rig, latencies_are_ticks_of_the_past) {
    const Seen punctual = run_idle(setup_with());
    const Seen late =
        run_idle(setup_with([](BoardFile &file) { file.board.sensor[1].latency_us = 7000; }));
    for (std::size_t i = 7; i < late.stimuli.size(); ++i) {
        ASSERT_EQ(late.stimuli[i].counts[1], punctual.stimuli[i - 7].counts[1]) << i;
        ASSERT_EQ(late.stimuli[i].counts[0], punctual.stimuli[i].counts[0]) << i;
    }
    EXPECT_EQ(late.stimuli[6].counts[1], 0);
}

/// A sensor file's contents, in this unit.
quiesce::SensorParams sensor_in(const std::string &unit) {
    return {"one", unit, 0.0, 0.0, 0.0, 0.0, 100.0, 0.0, 0.0};
}

TEST(Rig, a_sensors_file_is_before_its_samples) {
    const Seen ideal = run_idle(setup_with());
    const Seen led = run_idle(setup_with({}, [](PlantModel &model) {
        quiesce::SensorParams params = sensor_in("um/s2");
        params.corner_Hz = 1.0;
        model.sensors["roof_accel"] = {params, ""};
    }));
    quiesce::SensorParams same = sensor_in("um/s2");
    same.corner_Hz = 1.0;
    quiesce::SensorDynamics expected(same, 1000, 0);
    const double scale = 1e-3 * board().board.sensor[1].scale;
    for (std::size_t i = 0; i < led.stimuli.size(); ++i) {
        const double shown = expected.step(1e6 * led.roof[i].accel_m_s2, 0.0, 0.0);
        ASSERT_NEAR(led.stimuli[i].counts[1] * scale, shown, 0.51 * scale) << i;
        ASSERT_EQ(led.stimuli[i].counts[0], ideal.stimuli[i].counts[0]) << i;
    }
}

TEST(Rig, cross_talk_is_of_the_place_or_damper_that_is_named) {
    const Seen seen = run_idle(setup_with({}, [](PlantModel &model) {
        quiesce::SensorParams accel = sensor_in("um/s2");
        accel.cross_talk = 0.5;
        model.sensors["roof_accel"] = {accel, "floor"};
        quiesce::SensorParams stroke = sensor_in("nm");
        stroke.cross_talk = 0.25;
        model.sensors["upper_stroke"] = {stroke, "lower"};
    }));
    const std::size_t last = seen.stimuli.size() - 1;
    const double scale = 1e-3 * board().board.sensor[1].scale;
    EXPECT_NEAR(seen.stimuli[last].counts[1] * scale,
                1e6 * (seen.roof[last].accel_m_s2 + 0.5 * seen.floor[last].accel_m_s2),
                0.51 * scale);
    EXPECT_NEAR(1e3 * seen.stimuli[last].counts[2],
                1e9 * (seen.upper[last].stroke_m + 0.25 * seen.lower[last].stroke_m), 0.51e3);
}

TEST(Rig, a_sensors_file_must_fit_the_board) {
    expect_in("sensors.cellar", refusal({}, [](PlantModel &model) {
                  model.sensors["cellar"] = {sensor_in("um/s2"), ""};
              }));
    expect_in("its file is in nm, but acceleration of the board is in um/s2",
              refusal({}, [](PlantModel &model) {
                  model.sensors["roof_accel"] = {sensor_in("nm"), ""};
              }));
    expect_in("sensors.roof_accel.cross_talk_from 'lower' of the plant: the plant has no such one",
              refusal({}, [](PlantModel &model) {
                  model.sensors["roof_accel"] = {sensor_in("um/s2"), "lower"};
              }));
}

TEST(Rig, noise_of_the_plant_is_before_that_of_the_sensors_file) {
    const auto noisy = [](PlantModel &model) {
        quiesce::SensorParams params = sensor_in("um/s2");
        params.noise = 500.0;
        model.sensors["floor_accel"] = model.sensors["roof_accel"] = {params, ""};
        model.noise["roof_accel"] = 20.0;
    };
    const RunSetup setup = setup_with({}, noisy);
    EXPECT_EQ(setup.rig->noise, (std::vector<double>{500.0, 20.0, 0.0}));
}

/// 1 A for the lower damper, 0.5 A for the upper one.
class TwoCurrents final : public quiesce::ControllerLink {
  public:
    std::string target() const override { return "two"; }
    quiesce::StartAnswer start(const quiesce_board_t *board, const quiesce_params_t & /*params*/,
                               const quiesce::Tables & /*tables*/) override {
        return {board != nullptr};
    }
    void exchange(const lockstep_stimulus_t & /*in*/, lockstep_reply_t &reply) override {
        reply = lockstep_reply_t{};
        reply.current_cmd_mA[0] = 1000;
        reply.current_cmd_mA[1] = 500;
        reply.drivers_enabled = 3;
    }
    std::optional<quiesce::InstructionCounts> finish() override { return std::nullopt; }
};

TEST(Rig, each_damper_gets_its_current_after_the_bus) {
    const auto at_once = [](PlantModel &model) {
        model.dampers[0].coil = model.dampers[1].coil = {0.0, 0.0};
    };
    TwoCurrents link;
    const Seen seen =
        run(setup_with([](BoardFile &file) { file.board.bus_latency_us = 4000; }, at_once), link);
    for (std::size_t i = 0; i < 20; ++i) {
        // Answered in tick 0, at the driver in tick 1, or 4 later; seen at its end.
        EXPECT_NEAR(seen.lower[i].coil_A, i < 6 ? 0.0 : 1.0, 1e-3) << i;
        EXPECT_NEAR(seen.upper[i].coil_A, i < 6 ? 0.0 : 0.5, 1e-3) << i;
    }
}

TEST(Rig, a_driver_that_measures_says_its_current) {
    TwoCurrents link;
    const Seen seen =
        run(setup_with([](BoardFile &file) { file.board.damper[1].measures_current = 1; }), link);
    const lockstep_stimulus_t &last = seen.stimuli.back();
    EXPECT_EQ(last.flags & LOCKSTEP_HAS_CURRENT * 3u, LOCKSTEP_HAS_CURRENT << 1);
    EXPECT_NEAR(last.current_meas_mA[1], 500, 2);
}

TEST(Rig, faults_befall_what_they_name) {
    RunSetup setup = setup_with();
    setup.scenario.faults = {{FaultKind::dropout, 0.2, 0.1, "upper_stroke"},
                             {FaultKind::dropout, 0.4, 0.1},
                             {FaultKind::coil_open, 0.5, 0.5, "upper"}};
    TwoCurrents link;
    const Seen seen = run(setup, link);
    EXPECT_EQ(seen.stimuli[250].flags, LOCKSTEP_ENABLE | LOCKSTEP_FRESH * 3u);
    EXPECT_EQ(seen.stimuli[450].flags, LOCKSTEP_ENABLE | LOCKSTEP_FRESH * 5u); // the tracked one
    EXPECT_NEAR(seen.lower[900].coil_A, 1.0, 1e-2);
    EXPECT_EQ(seen.upper[900].coil_A, 0.0);
    setup.scenario.faults = {{FaultKind::coil_open, 0.5, 0.5, "roof_accel"}};
    EXPECT_THROW(run(setup, link), quiesce::InputError);
    setup.scenario.faults = {{FaultKind::dropout, 0.5, 0.5, "upper"}};
    EXPECT_THROW(run(setup, link), quiesce::InputError);
}

TEST(Rig, the_controller_sees_what_moves) {
    RunSetup setup = setup_with();
    setup.scenario.duration_s = 8.0;
    setup.wants_picture = true;
    setup.params.law = QUIESCE_LAW_OFF;
    quiesce::InProcessLink link;
    const Seen seen = run(setup, link);
    double worst_m = 0.0;
    double largest_m = 0.0;
    for (std::size_t i = 6000; i < seen.replies.size(); ++i) {
        const quiesce_picture_t &picture = seen.replies[i].picture;
        EXPECT_EQ(picture.damper[1].stroke_nm / 1000, seen.stimuli[i].counts[2]);
        worst_m = std::max(worst_m, std::abs(1e-9 * picture.body[1].displacement_nm -
                                             seen.roof[i].displacement_m));
        largest_m = std::max(largest_m, std::abs(seen.roof[i].displacement_m));
    }
    // At 3 Hz two leaky integrators at 0.5 Hz lead by 19 degrees, the DC removal at 0.2 Hz by 4:
    // 2 sin(11.5 degrees) is 0.40.
    EXPECT_LT(worst_m, 0.42 * largest_m);
    EXPECT_GT(largest_m, 0.01);
}

TEST(Rig, metrics_are_those_of_the_ticks_in_the_window) {
    RunSetup setup = setup_with();
    setup.scenario.windows = {{0.25, 0.75}};
    quiesce::RigMetrics metrics(setup);
    Seen seen;
    Recorder recorder(seen);
    TwoCurrents link;
    run_scenario(setup, link, {&metrics, &recorder});
    double squares = 0.0;
    double peak_N = 0.0;
    for (std::size_t i = 250; i < 750; ++i) {
        squares += seen.roof[i].displacement_m * seen.roof[i].displacement_m;
        peak_N = std::max(peak_N, std::abs(seen.lower[i].force_N));
    }
    const quiesce::RigWindow &window = metrics.windows().at(0);
    EXPECT_NEAR(window.bodies[1].displacement_rms_m(), std::sqrt(squares / 500.0), 1e-12);
    EXPECT_EQ(window.dampers[0].peak_force_N, peak_N);
    EXPECT_NEAR(window.dampers[1].mean_current_A(), 0.5, 1e-3);
}

struct Mistake {
    const char *name;
    const char *options;
    const char *says;
};

void PrintTo(const Mistake &mistake, std::ostream *out) {
    *out << mistake.name;
}

class RigMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(RigMistakes, exit_with_2_and_one_line) {
    const quiesce::Outcome outcome = quiesce::bench(GetParam().options);
    EXPECT_EQ(outcome.exit_code, 2);
    expect_in(GetParam().says, outcome.output);
    EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1);
}

INSTANTIATE_TEST_SUITE_P(
    Rig, RigMistakes,
    testing::Values(
        Mistake{"board_parameter",
                "run --scenario sim_hil/data/rigs/two_storeys.toml --law off --set "
                "safe_current_mA=1",
                "comes from the board file"},
        Mistake{"no_board",
                "run --scenario sim_hil/data/rigs/two_storeys.toml --law off --board no", "no"},
        Mistake{"plant_without_places",
                "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --board "
                "sim_hil/data/boards/two_storeys.toml",
                "body 'floor'"},
        Mistake{"plant_of_several_without_board",
                "run --scenario sim_hil/data/scenarios/sine_5Hz.toml --law off --plant "
                "sim_hil/data/plants/two_storeys.toml",
                "damper"},
        Mistake{"replay_of_half_a_tick",
                "replay --counts LICENSE --trace /dev/null --law off --board "
                "sim_hil/data/boards/two_storeys.toml",
                "counts"}),
    [](const auto &one) { return std::string(one.param.name); });

} // namespace
