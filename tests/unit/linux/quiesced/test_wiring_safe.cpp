/// --make-safe with several outputs of a board.
#include <gtest/gtest.h>

#include <algorithm>

#include <fcntl.h>
#include <unistd.h>

#include "devices.h"
#include "input_error.h"
#include "kept_config.h"
#include "make_safe.h"
#include "read_config.h"
#include "two_storeys.h"

extern "C" {
#include "can_make.h"
}

#include "slcan.h"

namespace quiesced {
namespace {

class SafeOutputs : public testing::Test {
  protected:
    void SetUp() override {
        master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
        ASSERT_GE(master_, 0);
        ASSERT_EQ(grantpt(master_), 0);
        ASSERT_EQ(unlockpt(master_), 0);
        rig.write_config(bus());
    }

    void TearDown() override { close(master_); }

    std::string bus() const {
        return std::string("[can]\ninterface = \"slcan:") + ptsname(master_) + "\"\n";
    }

    /// Demands that have come, by damper; each is a farewell.
    std::array<int, 4> farewells(const std::array<int, 2> &safe_mA) const {
        std::array<int, 4> counts{};
        slcan_decoder_t decoder;
        slcan_decoder_init(&decoder);
        std::uint8_t byte = 0;
        can_frame_t frame;
        while (read(master_, &byte, 1) == 1) {
            const bool is_whole = slcan_decode(&decoder, byte, &frame);
            const std::uint32_t damper = frame.id - QUIESCE_CAN_CURRENT_DEMAND_FRAME_ID;
            if (is_whole && damper < counts.size()) {
                quiesce_can_current_demand_t demand{};
                quiesce_can_current_demand_unpack(&demand, frame.data, frame.length);
                EXPECT_TRUE(is_well_made(&frame));
                EXPECT_EQ(demand.current_cmd_mA, safe_mA.at(damper));
                EXPECT_EQ(demand.driver_is_enabled, 0);
                ++counts[damper];
            }
        }
        return counts;
    }

    std::string duty() const { return rig.first_line("pwm/pwmchip0/pwm0/enable"); }
    std::string code() const { return rig.first_line("iio/iio:device3/out_voltage0_raw"); }

    /// As a controller that died has left them.
    void leave_outputs_on() const {
        write_text(rig.folder / "pwm/pwmchip0/pwm0/enable", "1\n");
        write_text(rig.folder / "iio/iio:device3/out_voltage0_raw", "2000\n");
    }

    TwoStoreys rig;
    int master_ = -1;
};

TEST_F(SafeOutputs, every_output_and_every_driver_on_the_bus) {
    leave_outputs_on();
    EXPECT_EQ(make_safe(rig.config_file(), rig.folders()), 0);
    EXPECT_EQ(duty(), "0");
    EXPECT_EQ(code(), "7");
    EXPECT_EQ(farewells({40, 60}), (std::array<int, 4>{5, 5, 0, 0}));
}

TEST_F(SafeOutputs, one_that_fails_keeps_none_of_the_others_from_it) {
    leave_outputs_on();
    std::filesystem::remove_all(rig.folder / "pwm/pwmchip0");
    EXPECT_EQ(make_safe(rig.config_file(), rig.folders()), 1);
    EXPECT_EQ(code(), "7");
    EXPECT_EQ(farewells({40, 60}), (std::array<int, 4>{5, 5, 0, 0}));
}

/// Nothing is kept, and the file has a mistake: every output that can be read is still made safe.
TEST_F(SafeOutputs, a_table_with_a_wrong_name_is_made_safe_all_the_same) {
    const std::string good = rig.text("q.toml");
    for (const std::string name : {"lower", "upper"}) {
        std::string wrong = good;
        const std::string table = "[[damper]]\nname = \"" + name + "\"";
        ASSERT_NE(wrong.find(table), std::string::npos);
        wrong.replace(wrong.find(table), table.size(), "[[damper]]\nname = \"lowr\"");
        write_text(rig.folder / "q.toml", wrong);
        leave_outputs_on();
        EXPECT_EQ(make_safe(rig.config_file(), rig.folders()), 1);
        EXPECT_EQ(duty(), "0") << name;
        EXPECT_EQ(code(), "7") << name;
    }
}

TEST_F(SafeOutputs, the_board_that_ran_is_kept_with_the_configuration) {
    const ReadConfig read = require_config_text(rig.config_file());
    EXPECT_EQ(read.board_text, rig.text("rig.board.toml"));
    quiesce_params_t params = read.config.params;
    params.max_current_mA = 5000;
    ASSERT_EQ(KeptConfig(rig.folder.path()).keep(read.text, read.board_text, params), "");
    std::string edited = read.board_text;
    edited.replace(edited.find("safe_mA = 40"), 12, "safe_mA = 999");
    write_text(rig.folder / "rig.board.toml", edited);
    leave_outputs_on();
    EXPECT_EQ(make_safe(rig.config_file(), rig.folders()), 0);
    EXPECT_EQ(duty(), "0");
    EXPECT_EQ(code(), "7");
    EXPECT_EQ(farewells({40, 60}), (std::array<int, 4>{5, 5, 0, 0})); // not 999
}

TEST_F(SafeOutputs, a_configuration_without_a_board_forgets_that_of_an_earlier_one) {
    const KeptConfig kept(rig.folder.path());
    const ReadConfig read = require_config_text(rig.config_file());
    ASSERT_EQ(KeptConfig(rig.folder.path()).keep(read.text, read.board_text, read.config.params),
              "");
    EXPECT_TRUE(std::filesystem::exists(kept.board_file()));
    ASSERT_EQ(KeptConfig(rig.folder.path()).keep("[can]\n", "", read.config.params), "");
    EXPECT_FALSE(std::filesystem::exists(kept.board_file()));
}

TEST(OtherDampers, on_the_same_bus_are_told_where_there_were_fewer) {
    Config config;
    config.can.emplace().interface = "can0";
    Config more = config;
    more.outputs.resize(2);
    EXPECT_FALSE(other_outputs(config, more).can);
    EXPECT_TRUE(other_outputs(more, config).can);
}

TEST(OtherDampers, an_output_is_the_same_for_whatever_damper) {
    Config config;
    config.outputs.resize(2);
    for (std::uint32_t i = 0; i < 2; ++i) {
        config.outputs[i].output = CurrentOutput::pwm;
        config.outputs[i].device = "pwmchip0";
        config.outputs[i].channel = i;
    }
    Config swapped = config;
    std::swap(swapped.outputs[0], swapped.outputs[1]);
    swapped.outputs.pop_back(); // channel 1 is left
    const Config left = other_outputs(config, swapped);
    EXPECT_EQ(left.outputs[0].output, CurrentOutput::pwm);
    EXPECT_EQ(left.outputs[1].output, CurrentOutput::can);
}

/// The DAC by its folder and by its name.
TEST(SharedOutputs, are_refused_under_two_names) {
    const TwoStoreys rig;
    Config config;
    config.folders = rig.folders();
    config.outputs.resize(2);
    for (OutputConfig &output : config.outputs) {
        output.output = CurrentOutput::dac;
        output.place = {"damper", 0, "upper", "damper upper"};
    }
    config.outputs[0].device = "dac";
    config.outputs[1].device = "iio:device3";
    EXPECT_THROW(refuse_shared_outputs(config), quiesce::InputError);
    config.outputs[1].channel = 1;
    EXPECT_NO_THROW(refuse_shared_outputs(config));
    config.outputs[1] = config.outputs[0];
    config.outputs[1].output = CurrentOutput::can;
    EXPECT_NO_THROW(refuse_shared_outputs(config));
}

TEST(SharedOutputs, a_second_name_of_a_pwm_chip_is_the_same_chip) {
    const TwoStoreys rig;
    std::filesystem::create_directory_symlink(rig.folders().pwm + "/pwmchip0",
                                              rig.folders().pwm + "/coil");
    Config config;
    config.folders = rig.folders();
    config.outputs.resize(2);
    config.outputs[0].output = config.outputs[1].output = CurrentOutput::pwm;
    config.outputs[0].device = "pwmchip0";
    config.outputs[1].device = "coil";
    EXPECT_THROW(refuse_shared_outputs(config), quiesce::InputError);
    config.outputs[0].device = config.outputs[1].device = "none"; // opening tells
    EXPECT_NO_THROW(refuse_shared_outputs(config));
}

} // namespace
} // namespace quiesced
