#include <gtest/gtest.h>

#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

#include "input_error.h"
#include "kept_config.h"
#include "make_safe.h"
#include "read_config.h"
#include "temporary_folder.h"

namespace quiesced {
namespace {

Config board() {
    Config config;
    config.gpio.enable_output = LineConfig{"ENABLE", false, 0};
    config.gpio.fault_output = LineConfig{"FAULT", false, 0};
    config.outputs.front().output = CurrentOutput::pwm;
    config.outputs.front().device = "pwmchip0";
    config.can.emplace().interface = "can0";
    return config;
}

TEST(OtherOutputs, the_same_configuration_has_none) {
    const Config left = other_outputs(board(), board());
    EXPECT_FALSE(left.gpio.enable_output || left.gpio.fault_output || left.can);
    EXPECT_EQ(left.outputs.front().output, CurrentOutput::can);
}

TEST(OtherOutputs, other_settings_of_an_output_do_not_undo_what_made_it_safe) {
    Config edited = board();
    edited.gpio.enable_output->is_active_low = true; // inactive by this one: the driver is on
    std::swap(edited.gpio.enable_output, edited.gpio.fault_output);
    edited.outputs.front().is_inverted = true; // no duty: full current
    edited.can->use_fd = true;
    const Config left = other_outputs(edited, board());
    EXPECT_FALSE(left.gpio.enable_output || left.gpio.fault_output || left.can);
    EXPECT_EQ(left.outputs.front().output, CurrentOutput::can);
}

TEST(OtherOutputs, another_output_is_one) {
    Config edited = board();
    edited.gpio.enable_output->line = "ENABLE2";
    edited.outputs.front().channel = 1;
    edited.can->interface = "can1";
    const Config left = other_outputs(edited, board());
    ASSERT_TRUE(left.gpio.enable_output && left.can);
    EXPECT_FALSE(left.gpio.fault_output);
    EXPECT_EQ(left.outputs.front().output, CurrentOutput::pwm);
}

TEST(KeptConfig, comes_back_with_the_parameters_in_effect) {
    const TemporaryFolder folder;
    KeptConfig kept(folder.path());
    EXPECT_FALSE(kept.load() || kept.load_params());
    quiesce_params_t params{};
    quiesce_params_default(&params);
    params.safe_current_mA = 40;
    ASSERT_EQ(kept.keep("[can]\ninterface = 'can7'\n", "", params), "");
    ASSERT_TRUE(kept.load() && kept.load_params());
    EXPECT_EQ(kept.load()->config.can->interface, "can7");
    EXPECT_EQ(kept.load_params()->safe_current_mA, 40);
    params.safe_current_mA = -1;
    ASSERT_EQ(kept.keep_params(params), "");
    EXPECT_FALSE(kept.load_params());
}

TEST(KeptConfig, what_cannot_be_kept_is_not_there) {
    const TemporaryFolder folder;
    KeptConfig kept(folder.path());
    const quiesce_params_t params{};
    ASSERT_EQ(kept.keep("[can]\n", "", params), "");
    std::filesystem::create_directory(kept.config_file() + ".new");
    EXPECT_NE(kept.keep("[can]\n", "", params), "");
    EXPECT_FALSE(kept.load() || kept.load_params());
    std::filesystem::create_directory(kept.params_file() + ".new");
    EXPECT_NE(kept.keep_params(params), "");
}

TEST(KeptConfig, text_is_that_of_the_file) {
    const TemporaryFolder folder;
    const std::string text = "[can]\ninterface = 'can0'\n[accel]\nsource = 'can'\n[current]\n"
                             "output = 'can' # \xC3\xBC\n";
    write_text(folder / "q.toml", text);
    EXPECT_EQ(require_config_text(folder / "q.toml").text, text);
    EXPECT_THROW(require_config_text(folder / "none.toml"), quiesce::InputError);
}

TEST(FallbackFolder, is_what_the_service_manager_says) {
    (void)unsetenv("STATE_DIRECTORY");
    EXPECT_EQ(fallback_state_folder(), "/var/lib/quiesced");
    for (const char *wrong : {"", "relative", ":/a"}) {
        (void)setenv("STATE_DIRECTORY", wrong, 1);
        EXPECT_EQ(fallback_state_folder(), "/var/lib/quiesced");
    }
    (void)setenv("STATE_DIRECTORY", "/a:/b", 1);
    EXPECT_EQ(fallback_state_folder(), "/a");
    (void)unsetenv("STATE_DIRECTORY");
}

} // namespace
} // namespace quiesced
