#include <gtest/gtest.h>

#include <string>

#include "arguments.h"
#include "input_error.h"
#include "link_factory.h"
#include "param_options.h"
#include "run_options.h"

namespace {

using quiesce::Arguments;
using quiesce::InputError;

template <typename Action>
std::string message_of(Action action) {
    try {
        action();
    } catch (const InputError &error) {
        return error.what();
    }
    return "accepted";
}

quiesce_params_t defaults() {
    quiesce_params_t params;
    quiesce_params_default(&params);
    return params;
}

std::string set_message(const std::string &assignment) {
    return message_of([&assignment] {
        quiesce_params_t params = defaults();
        quiesce::set_param(params, assignment);
    });
}

TEST(Arguments, takes_declared_options_only) {
    const Arguments arguments("run", {"--seed", "3", "--set", "a=1", "--set", "b=2"},
                              {"seed", "set", "law"});
    EXPECT_EQ(arguments.integer("seed", 0, 10), 3);
    EXPECT_EQ(arguments.all("set").size(), 2u);
    EXPECT_FALSE(arguments.text("law").has_value());
    EXPECT_EQ(message_of([&] { arguments.required("law"); }), "run: option --law is missing");
    EXPECT_EQ(message_of([&] { arguments.text("set"); }),
              "run: option --set is given more than once");
    EXPECT_EQ(message_of([] {
                  Arguments("run", {"--what", "1"}, {"seed"});
              }),
              "run: unknown option --what");
    EXPECT_EQ(message_of([] { Arguments("run", {"--seed"}, {"seed"}); }),
              "run: option --seed needs a value");
    EXPECT_EQ(message_of([] { Arguments("run", {"stray"}, {}).require_no_positional(); }),
              "run: unexpected word stray");
    EXPECT_EQ(message_of([] { Arguments("plant-check", {}, {}).only_positional("FILE"); }),
              "plant-check: expected exactly one FILE");
}

TEST(Arguments, numbers_are_whole_words_in_range) {
    for (const char *bad : {"", "x", "1x", "1.5", "11", "-1", "99999999999999999999"}) {
        const Arguments arguments("run", {"--seed", bad}, {"seed"});
        EXPECT_NE(message_of([&] { arguments.integer("seed", 0, 10); }).find("--seed"),
                  std::string::npos)
            << bad;
    }
    for (const char *bad : {"", "nan", "inf", "1e99", "1,5", "-0.1"}) {
        const Arguments arguments("run", {"--noise-mg", bad}, {"noise-mg"});
        EXPECT_NE(message_of([&] { arguments.number("noise-mg", 0.0, 1e4); }).find("--noise-mg"),
                  std::string::npos)
            << bad;
    }
}

TEST(SetParam, integers_and_labels) {
    quiesce_params_t params = defaults();
    quiesce::set_param(params, "constant_current_mA=1234");
    quiesce::set_param(params, "law=constant");
    EXPECT_EQ(params.constant_current_mA, 1234);
    EXPECT_EQ(params.law, QUIESCE_LAW_CONSTANT);
    EXPECT_EQ(quiesce::law_label(params), "constant");
}

TEST(SetParam, mistakes_name_the_parameter) {
    EXPECT_NE(set_message("warp=1").find("--set warp: unknown parameter"), std::string::npos);
    EXPECT_NE(set_message("law").find("expected NAME=VALUE"), std::string::npos);
    EXPECT_NE(set_message("law=magic").find("law expects an integer in 0 .. "), std::string::npos);
    EXPECT_NE(set_message("law=magic").find("fuzzy"), std::string::npos) << "lists the labels";
    EXPECT_NE(set_message("max_current_mA=1.5").find("max_current_mA expects"), std::string::npos);
    EXPECT_NE(set_message("max_current_mA=99999999").find("max_current_mA"), std::string::npos);
    EXPECT_NE(set_message("max_current_mA=").find("max_current_mA"), std::string::npos);
}

TEST(SetParam, contradictions_are_refused_with_their_reason) {
    quiesce_params_t params = defaults();
    params.tick_rate_Hz = 1234;
    EXPECT_NE(message_of([&] { quiesce::require_accepted(params); }).find("tick_rate_Hz"),
              std::string::npos);
}

TEST(SensorFit, sets_scale_and_full_scale) {
    quiesce_params_t params = defaults();
    quiesce::fit_to_sensor(params, {49.4, 24, 0.0, 0});
    EXPECT_EQ(params.accel_scale_nm_s2, defaults().accel_scale_nm_s2);
    EXPECT_EQ(params.accel_full_scale_counts, defaults().accel_full_scale_counts);
    quiesce::fit_to_sensor(params, {4.0, 16, 0.0, 0});
    EXPECT_EQ(params.accel_scale_nm_s2, 1197101);
    EXPECT_EQ(params.accel_full_scale_counts, 32767);
}

TEST(RunSetup, overrides_win_over_scenario_and_plant) {
    const Arguments arguments("run",
                              {"--scenario", "sim_hil/data/scenarios/sine_5Hz.toml", "--law", "off",
                               "--noise-mg", "0.25", "--dt-us", "125", "--seed", "9", "--plant",
                               "sim_hil/data/plants/squeeze_2012.toml"},
                              quiesce::run_option_names());
    const quiesce::RunSetup setup = quiesce::run_setup(arguments);
    EXPECT_EQ(setup.plant.sensor.noise_mg, 0.25);
    EXPECT_DOUBLE_EQ(setup.plant.max_step_s, 125e-6);
    EXPECT_EQ(setup.seed, 9u);
    EXPECT_EQ(setup.params.law, QUIESCE_LAW_OFF);
}

TEST(RunSetup, too_long_a_step_is_refused) {
    const Arguments arguments(
        "run",
        {"--scenario", "sim_hil/data/scenarios/sine_5Hz.toml", "--law", "off", "--dt-us", "2000"},
        quiesce::run_option_names());
    EXPECT_NE(message_of([&] { quiesce::run_setup(arguments); }).find("--dt-us"),
              std::string::npos);
}

TEST(MakeLink, knows_its_targets) {
    EXPECT_EQ(quiesce::make_link("host", {})->target(), "host");
    EXPECT_NE(message_of([] { quiesce::make_link("moon", {}); }).find("choose one of: host"),
              std::string::npos);
}

} // namespace
